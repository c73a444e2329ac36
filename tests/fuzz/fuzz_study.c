#include "fuzz.h"

#include "evaluate/study_plan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvStudyPlan plan;
    ShvError error = {SHV_OK, ""};
    const ShvStatus status = shv_study_plan_read(&plan, (const char *)data, size, "study.yaml", NULL, 0, NULL, &error);
    fuzz_judge(status, &error);
    if (status == SHV_OK) shv_study_plan_release(&plan);
    return 0;
}

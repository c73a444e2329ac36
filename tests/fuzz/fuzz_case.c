#include "fuzz.h"

#include "evaluate/case.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvPool work = {0}, texts = {0};
    ShvDiagnostics *diagnostics = shv_diagnostics_create(NULL, "case.yaml", NULL, 0);
    if (!diagnostics) return 0;
    const ShvCaseItem *item = shv_case_read((const char *)data, size, &work, &texts, diagnostics);
    if (!item && shv_diagnostics_errors(diagnostics) == 0 && !work.failed && !texts.failed) abort();
    shv_pool_release(&work);
    shv_pool_release(&texts);
    shv_diagnostics_destroy(diagnostics);
    return 0;
}

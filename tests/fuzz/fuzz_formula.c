#include "fuzz.h"

#include "evaluate/formula.h"

static bool find(void *data, const char *name, ShvFormulaValue *value)
{
    static const double times[] = {0.0, 0.5, 1.0, 2.0}, values[] = {1.0, -1.0, 3.0, 0.0};
    (void)data;
    if (name[0] == 'x') *value = (ShvFormulaValue){.number = 2.5};
    if (name[0] == 's') *value = (ShvFormulaValue){true, 0.0, times, values, 4};
    return name[0] == 'x' || name[0] == 's';
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvPool pool = {0};
    ShvFormulaValue value;
    ShvError error = {SHV_OK, ""};
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    const ShvFormulaNames names = {.find = find, .pool = &pool};
    fuzz_judge(shv_formula_evaluate(text, &names, &value, &error), &error);
    shv_pool_release(&pool);
    free(text);
    return 0;
}

#include "scene/reference.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "base/text.h"
#include "scene/schema.h"

/* A text that grows; a failure sticks. */
typedef struct Page {
    ShvMemory *memory;
    char *text;
    size_t length, capacity;
    bool failed;
} Page;

static void put(Page *page, const char *format, ...)
{
    enum { LONGEST_PIECE = 4000 };
    if (!page->failed && page->capacity - page->length < LONGEST_PIECE) {
        const size_t capacity = 2 * page->capacity + 4 * LONGEST_PIECE;
        char *text = shv_reallocate(page->memory, SHV_PART_SCENE, page->text, capacity, 1);
        page->failed = !text;
        if (text) {
            page->text = text;
            page->capacity = capacity;
        }
    }
    if (page->failed) return;
    va_list arguments;
    va_start(arguments, format);
    const int length = shv_format_list(page->text + page->length, page->capacity - page->length, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= page->capacity - page->length)
        page->failed = true;
    else
        page->length += (size_t)length;
}

static const char introduction[] =
    "# Scene files\n"
    "\n"
    "A scene is one YAML document in UTF-8. This page is made from the tables that read scenes.\n"
    "\n"
    "```yaml\n"
    "shiver: 1\n"
    "name: glass plate drop\n"
    "materials:\n"
    "  glass: {density: 2500, youngs_modulus: 70 GPa, poissons_ratio: 0.22, fracture_energy: 8, cohesive_strength: 40 "
    "MPa}\n"
    "objects:\n"
    "  plate:\n"
    "    mesh: {box: {size: [0.3, 0.3, 0.006], edge: 3 mm}}\n"
    "    material: glass\n"
    "    position: [0, 0, 1.2]\n"
    "    rotation: {axis: [1, 0, 0], angle: 25}\n"
    "obstacles:\n"
    "  floor: {plane: {normal: [0, 0, 1]}, friction: 0.4}\n"
    "duration: 1.5\n"
    "```\n"
    "\n"
    "- A number without a unit is in the unit that the tables below name; `3 mm` or `70 GPa` is converted. Each "
    "component of a "
    "list may have its own unit. A unit of another kind is an error. The decimal mark is a point in every language.\n"
    "- Axes are right-handed, z is up. Obstacles rest where they are put; objects start with the velocities given.\n"
    "- Names of materials, objects and so on are made of letters, digits, `_` and `-`. Objects and obstacles share one "
    "set of "
    "names; so do supports, imposed velocities and tractions.\n"
    "- Relative names of files that are read start from the folder of the scene file.\n"
    "- `--set a.b.c=value` puts a value in the place of a key, or adds it: `--set materials.glass.density=2600`. List "
    "elements "
    "are counted from 0: `--set gravity.2=-1.62`, `--set events.0.at=0.5`. A new name is added as a whole: "
    "`--set 'obstacles.wall={plane: {normal: [1, 0, 0]}}'`.\n"
    "- Anchors and aliases (`&name`, `*name`) work; tags and further documents are errors. A scene has at most 16 MiB "
    "and a "
    "million values.\n"
    "- All faults are listed at once, as `file:line:column: error: ...`. Warnings do not stop a run.\n"
    "\n"
    "## Units\n"
    "\n"
    "| kind | units; the first is that of bare numbers |\n"
    "|---|---|\n";

static void put_number(Page *page, double value)
{
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        shv_format(text, sizeof text, "%.*g", digits, value);
        if (shv_text_to_double(text, NULL) == value) break;
    }
    put(page, "%s", isinf(value) ? ".inf" : text);
}

static void put_vector(Page *page, const char *at)
{
    double vector[3];
    memcpy(vector, at, sizeof vector);
    put(page, "[");
    for (int i = 0; i < 3; i++) {
        if (i > 0) put(page, ", ");
        put_number(page, vector[i]);
    }
    put(page, "]");
}

static void put_axes(Page *page, const char *at)
{
    bool axes[3];
    memcpy(axes, at, sizeof axes);
    const char *mark = "";
    put(page, "[");
    for (int i = 0; i < 3; i++) {
        if (!axes[i]) continue;
        put(page, "%s%c", mark, "xyz"[i]);
        mark = ", ";
    }
    put(page, "]");
}

static int64_t integer_at(const ShvKey *key, const char *at)
{
    if (key->type == SHV_KEY_INT32) {
        int32_t narrow;
        memcpy(&narrow, at, sizeof narrow);
        return narrow;
    }
    int64_t wide;
    memcpy(&wide, at, sizeof wide);
    return wide;
}

/* The value that a struct of defaults has at `at`. */
static void put_value(Page *page, const ShvKey *key, const char *at)
{
    double number;
    bool truth;
    int choice;
    switch (key->type) {
    case SHV_KEY_NUMBER:
        memcpy(&number, at, sizeof number);
        put_number(page, number);
        break;
    case SHV_KEY_INT32:
    case SHV_KEY_INT64:
    case SHV_KEY_UINT64:
        put(page, "%lld", (long long)integer_at(key, at));
        break;
    case SHV_KEY_BOOLEAN:
        memcpy(&truth, at, sizeof truth);
        put(page, truth ? "true" : "false");
        break;
    case SHV_KEY_CHOICE:
        memcpy(&choice, at, sizeof choice);
        put(page, "%s", shv_choice_name(key->choices, choice));
        break;
    case SHV_KEY_VECTOR:
        put_vector(page, at);
        break;
    case SHV_KEY_AXES:
        put_axes(page, at);
        break;
    default:
        break;
    }
}

/* A mapping that must have some keys is something to add; another one only changes what is there anyway. */
static bool has_required_keys(const ShvTable *table)
{
    for (int i = 0; i < table->key_count; i++)
        if (table->keys[i].flags & SHV_KEY_REQUIRED) return true;
    return table->variants;
}

static void put_default(Page *page, const ShvKey *key, const char *base)
{
    if (key->flags & SHV_KEY_REQUIRED)
        put(page, "**required**");
    else if (key->flags & SHV_KEY_VARIANT)
        put(page, "**exactly one**");
    else if (key->absent)
        put(page, "%s", key->absent);
    else if (key->type == SHV_KEY_MAPPING)
        put(page, has_required_keys(key->table) ? "none" : "as below");
    else if (key->type == SHV_KEY_NAMED || key->type == SHV_KEY_LIST)
        put(page, "none");
    else
        put_value(page, key, base + key->offset);
}

static void put_type(Page *page, const ShvKey *key)
{
    static const char *const types[] = {[SHV_KEY_NUMBER] = "number",
                                        [SHV_KEY_INT32] = "whole number",
                                        [SHV_KEY_INT64] = "whole number",
                                        [SHV_KEY_UINT64] = "whole number, at least 0",
                                        [SHV_KEY_BOOLEAN] = "true or false",
                                        [SHV_KEY_TEXT] = "text",
                                        [SHV_KEY_CHOICE] = "",
                                        [SHV_KEY_VECTOR] = "[x, y, z]",
                                        [SHV_KEY_AXES] = "list of some of x, y, z",
                                        [SHV_KEY_MAPPING] = "mapping",
                                        [SHV_KEY_NAMED] = "mapping by name",
                                        [SHV_KEY_LIST] = "list of mappings"};
    put(page, "%s", key->flags & SHV_KEY_FILE ? "file name" : types[key->type]);
    for (const ShvChoice *choice = key->choices; choice && choice->name; choice++)
        put(page, "%s`%s`", choice == key->choices ? "" : ", ", choice->name);
    const char *unit = shv_dimension_unit(key->dimension, 0);
    if (unit) put(page, ", %s", unit);
    char range[100];
    shv_range_describe(key->range, range, sizeof range);
    if (range[0]) put(page, ", %s", range);
    if (key->flags & SHV_KEY_DIRECTION) put(page, ", not zero");
    if (key->flags & SHV_KEY_INFINITE) put(page, ", or `.inf`");
    if (key->flags & SHV_KEY_AUTOMATIC) put(page, ", or `auto`");
}

/* One section a table, depth first. `base` holds the defaults of the item that the table is part of. */
static void put_table(Page *page, const ShvTable *table, const char *base, ShvPool *pool)
{
    put(page, "\n## %s\n\n%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n", table->name,
        table->sentence);
    for (int i = 0; i < table->key_count; i++) {
        const ShvKey *key = &table->keys[i];
        put(page, "| `%s` | ", key->name);
        put_type(page, key);
        put(page, " | ");
        put_default(page, key, base);
        put(page, " | %s |\n", key->sentence);
    }
    for (int i = 0; i < table->key_count; i++) {
        const ShvKey *key = &table->keys[i];
        if (!key->table) continue;
        const char *below = base + key->offset;
        if (key->table->size > 0) {
            char *item = shv_pool_take(pool, 1, key->table->size);
            if (!item) return;
            shv_table_start(key->table, item);
            below = item;
        }
        put_table(page, key->table, below, pool);
    }
}

static void put_units(Page *page)
{
    for (int dimension = SHV_DIMENSION_NONE + 1; dimension < SHV_DIMENSION_COUNT; dimension++) {
        char units[120];
        shv_dimension_units((ShvDimension)dimension, units, sizeof units);
        put(page, "| %s | %s |\n", shv_dimension_name((ShvDimension)dimension), units);
    }
}

ShvStatus shv_scene_reference(ShvMemory *memory, char **text, ShvError *error)
{
    Page page = {.memory = memory};
    ShvPool pool = {.memory = memory};
    char *scene = shv_pool_take(&pool, 1, shv_scene_table.size);
    *text = NULL;
    if (scene) {
        shv_table_start(&shv_scene_table, scene);
        put(&page, "%s", introduction);
        put_units(&page);
        put_table(&page, &shv_scene_table, scene, &pool);
    }
    const bool failed = pool.failed || page.failed;
    shv_pool_release(&pool);
    if (failed) {
        shv_release(page.text);
        return shv_fail_memory(error, "the reference of scene files", page.capacity);
    }
    *text = page.text;
    return SHV_OK;
}

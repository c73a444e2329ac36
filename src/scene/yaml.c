/* YAML text to a tree, through libfyaml's stream of events: a document is left at the first fault, limit or end, and
   nothing is built that was not asked for. */
#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>

#include "scene/source.h"
#include "scene/tree.h"

enum { LARGEST_NODES = 1000000, LARGEST_ANCHORS = 256 };

typedef struct Anchor {
    const char *name;
    ShvNode *node;
} Anchor;

/* A mapping or list that is not closed yet. */
typedef struct Level {
    ShvNode *node, *key; /* key: of the value to come */
    const char *anchor;
} Level;

typedef struct Builder {
    ShvPool *pool;
    ShvDiagnostics *diagnostics;
    ShvNode *root;
    Level levels[SHV_SCENE_LARGEST_DEPTH];
    Anchor anchors[LARGEST_ANCHORS];
    int32_t depth, anchor_count, nodes, documents;
    ShvPlace last;
} Builder;

static void discard_output(struct fy_diag *diag, void *user, const char *text, size_t length)
{
    (void)diag;
    (void)user;
    (void)text;
    (void)length;
}

/* A value that is not there: versions of libfyaml tell different places. */
static bool is_missing(struct fy_event *event)
{
    if (event->type != FYET_SCALAR) return false;
    size_t length = 0;
    struct fy_token *token = event->scalar.value;
    return !token || (fy_token_get_text(token, &length) && length == 0 && fy_token_scalar_style(token) == FYSS_PLAIN);
}

/* Of a value that is not there: its key's. */
static ShvPlace place_of(Builder *builder, struct fy_event *event)
{
    const struct fy_mark *mark = is_missing(event) ? NULL : fy_event_start_mark(event);
    if (mark && mark->line >= 0) {
        builder->last.line = mark->line + 1;
        builder->last.column = mark->column + 1;
    }
    return builder->last;
}

/* The text of a token in the pool; NULL for no token, after a NUL in it (reported), or when memory is out. */
static const char *token_text(Builder *builder, struct fy_token *token, ShvPlace place)
{
    size_t length = 0;
    const char *text = token ? fy_token_get_text(token, &length) : NULL;
    if (!text) return NULL;
    if (memchr(text, '\0', length)) {
        shv_error(builder->diagnostics, place, "the text contains a zero byte, which no value may");
        return NULL;
    }
    return shv_pool_text(builder->pool, text, length);
}

static bool is_null_text(const char *text)
{
    static const char *const words[] = {"", "~", "null", "Null", "NULL"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(text, words[i]) == 0) return true;
    return false;
}

static bool add_anchor(Builder *builder, const char *name, ShvNode *node)
{
    for (int32_t i = 0; i < builder->anchor_count; i++) {
        if (strcmp(builder->anchors[i].name, name) != 0) continue;
        builder->anchors[i].node = node; /* YAML: the latest anchor of a name counts */
        return true;
    }
    if (builder->anchor_count == LARGEST_ANCHORS) {
        shv_error(builder->diagnostics, node->place, "more than %d anchors", (int)LARGEST_ANCHORS);
        return false;
    }
    builder->anchors[builder->anchor_count++] = (Anchor){name, node};
    return true;
}

static ShvNode *find_anchor(Builder *builder, struct fy_event *event, ShvPlace place)
{
    const char *name = token_text(builder, fy_event_get_token(event), place);
    if (!name) return NULL;
    for (int32_t i = 0; i < builder->anchor_count; i++)
        if (strcmp(builder->anchors[i].name, name) == 0) return builder->anchors[i].node;
    shv_error(builder->diagnostics, place, "alias *%.60s has no complete anchor &%.60s before it", name, name);
    return NULL;
}

/* Gives a finished node to the level above; the first of a mapping's nodes is a key, the second its value. */
static bool attach(Builder *builder, ShvNode *node)
{
    if (builder->depth == 0) {
        builder->root = node;
        return true;
    }
    Level *level = &builder->levels[builder->depth - 1];
    if (level->node->kind == SHV_NODE_LIST) return shv_tree_append(builder->pool, level->node, NULL, node);
    if (!level->key) {
        if (node->kind != SHV_NODE_SCALAR) {
            shv_error(builder->diagnostics, node->place, "%s stands where a key was expected; keys are plain words",
                      shv_node_kind_name(node->kind));
            return false;
        }
        level->key = node;
        return true;
    }
    const bool done = shv_tree_append(builder->pool, level->node, level->key, node);
    level->key = NULL;
    return done;
}

static int compare_keys(const void *first, const void *second)
{
    const ShvNode *a = *(ShvNode *const *)first, *b = *(ShvNode *const *)second;
    const int order = strcmp(a->text, b->text);
    if (order != 0) return order;
    if (a->place.line != b->place.line) return a->place.line < b->place.line ? -1 : 1;
    return (a->place.column > b->place.column) - (a->place.column < b->place.column);
}

static void report_duplicates(Builder *builder, const ShvNode *mapping)
{
    const ShvNode **keys = shv_pool_take(builder->pool, (size_t)mapping->count, sizeof *keys);
    if (!keys) return;
    int32_t count = 0;
    for (const ShvEntry *entry = mapping->first; entry; entry = entry->next) keys[count++] = entry->key;
    qsort(keys, (size_t)count, sizeof *keys, compare_keys);
    for (int32_t i = 1; i < count; i++)
        if (strcmp(keys[i - 1]->text, keys[i]->text) == 0)
            shv_error(builder->diagnostics, keys[i]->place, "key %s is given twice, before at line %d; keep one",
                      shv_quoted(keys[i]->text).text, (int)keys[i - 1]->place.line);
}

static bool open_level(Builder *builder, ShvNode *node, const char *anchor)
{
    if (builder->depth == SHV_SCENE_LARGEST_DEPTH) {
        shv_error(builder->diagnostics, node->place, "nested more than %d deep", (int)SHV_SCENE_LARGEST_DEPTH);
        return false;
    }
    builder->levels[builder->depth++] = (Level){node, NULL, anchor};
    return true;
}

static bool close_level(Builder *builder)
{
    const Level level = builder->levels[--builder->depth];
    if (level.node->kind == SHV_NODE_MAPPING) report_duplicates(builder, level.node);
    if (level.node->weight > LARGEST_NODES) {
        shv_error(builder->diagnostics, level.node->place,
                  "more than %d values, those of aliases counted as often as "
                  "they are used",
                  (int)LARGEST_NODES);
        return false;
    }
    if (level.anchor && !add_anchor(builder, level.anchor, level.node)) return false;
    return attach(builder, level.node);
}

static bool add_scalar(Builder *builder, ShvNode *node, struct fy_event *event, const char *anchor)
{
    struct fy_token *token = fy_event_get_token(event);
    const enum fy_scalar_style style = token ? fy_token_scalar_style(token) : FYSS_PLAIN;
    if (style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED)
        node->place.column--; /* the quote, not what follows */
    const char *text = token ? token_text(builder, token, node->place) : "";
    if (!text) return false;
    node->text = text;
    node->null = is_null_text(text) && style == FYSS_PLAIN;
    if (anchor && !add_anchor(builder, anchor, node)) return false;
    return attach(builder, node);
}

/* A scalar, or the start of a list or mapping. */
static bool add_node(Builder *builder, struct fy_event *event, ShvNodeKind kind)
{
    const ShvPlace place = place_of(builder, event);
    if (fy_event_get_tag_token(event)) {
        const struct fy_mark *tag = fy_token_start_mark(fy_event_get_tag_token(event));
        const ShvPlace at = tag ? (ShvPlace){tag->line + 1, tag->column + 1, place.origin} : place;
        shv_error(builder->diagnostics, at, "a tag (!...) stands here; scenes use none, remove it");
        return false;
    }
    if (builder->nodes++ == LARGEST_NODES) {
        shv_error(builder->diagnostics, place, "more than %d values", (int)LARGEST_NODES);
        return false;
    }
    ShvNode *node = shv_tree_node(builder->pool, kind, place);
    if (!node) return false;
    struct fy_token *token = fy_event_get_anchor_token(event);
    const char *anchor = token_text(builder, token, place);
    if (token && !anchor) return false;
    return kind == SHV_NODE_SCALAR ? add_scalar(builder, node, event, anchor) : open_level(builder, node, anchor);
}

static bool start_document(Builder *builder, struct fy_event *event)
{
    if (builder->documents++ == 0) return true;
    shv_error(builder->diagnostics, place_of(builder, event), "a second document begins here; a scene is a single one");
    return false;
}

static bool take_event(Builder *builder, struct fy_event *event)
{
    switch (event->type) {
    case FYET_DOCUMENT_START:
        return start_document(builder, event);
    case FYET_SCALAR:
        return add_node(builder, event, SHV_NODE_SCALAR);
    case FYET_SEQUENCE_START:
        return add_node(builder, event, SHV_NODE_LIST);
    case FYET_MAPPING_START:
        return add_node(builder, event, SHV_NODE_MAPPING);
    case FYET_SEQUENCE_END:
    case FYET_MAPPING_END:
        return close_level(builder);
    case FYET_ALIAS: {
        ShvPlace place = place_of(builder, event);
        place.column--; /* the star, not the name */
        ShvNode *node = find_anchor(builder, event, place);
        return node && attach(builder, node);
    }
    default:
        return true;
    }
}

static void report_syntax(Builder *builder, struct fy_diag *diag)
{
    void *iterator = NULL;
    int32_t reported = 0;
    for (struct fy_diag_error *fault; (fault = fy_diag_errors_iterate(diag, &iterator)); reported++) {
        const ShvPlace place = {fault->line > 0 ? fault->line : 1, fault->column > 0 ? fault->column : 1,
                                builder->last.origin};
        shv_error(builder->diagnostics, place, "not valid YAML: %.200s", fault->msg);
    }
    if (reported == 0) shv_error(builder->diagnostics, builder->last, "not valid YAML from here on");
}

static bool read_events(Builder *builder, struct fy_parser *parser, struct fy_diag *diag)
{
    struct fy_event *event;
    while ((event = fy_parser_parse(parser))) {
        const bool go_on = take_event(builder, event);
        fy_parser_event_free(parser, event);
        if (!go_on) return false;
    }
    if (!fy_parser_get_stream_error(parser)) return true;
    report_syntax(builder, diag);
    return false;
}

static bool run_parser(Builder *builder, struct fy_diag *diag, const char *text, size_t length)
{
    fy_diag_set_collect_errors(diag, true);
    const struct fy_parse_cfg configuration = {.flags = FYPCF_JSON_NONE | FYPCF_COLLECT_DIAG |
                                                        FYPCF_DEFAULT_VERSION_1_2 | FYPCF_DISABLE_MMAP_OPT,
                                               .diag = diag};
    struct fy_parser *parser = fy_parser_create(&configuration);
    bool done = false;
    if (parser && fy_parser_set_string(parser, text, length) == 0)
        done = read_events(builder, parser, diag);
    else
        builder->pool->failed = true; /* the library has nothing else to fail by here */
    if (parser) fy_parser_destroy(parser);
    return done;
}

ShvNode *shv_tree_read(ShvPool *pool, ShvDiagnostics *diagnostics, const char *text, size_t length, int32_t origin)
{
    const ShvPlace start = {1, 1, origin};
    if (!shv_source_check(diagnostics, text, length, origin)) return NULL;
    Builder *builder = shv_pool_take(pool, 1, sizeof *builder);
    if (!builder) return NULL;
    *builder = (Builder){.pool = pool, .diagnostics = diagnostics, .last = start};
    struct fy_diag_cfg quiet;
    fy_diag_cfg_default(&quiet);
    quiet.fp = NULL;
    quiet.output_fn = discard_output;
    struct fy_diag *diag = fy_diag_create(&quiet);
    if (!diag) {
        pool->failed = true;
        return NULL;
    }
    const bool done = run_parser(builder, diag, text, length);
    fy_diag_destroy(diag);
    if (done && !builder->root && origin > 0) return shv_tree_node(pool, SHV_NODE_SCALAR, start);
    if (done && !builder->root) shv_error(diagnostics, start, "the file is empty; a scene begins with 'shiver: 1'");
    return done ? builder->root : NULL;
}

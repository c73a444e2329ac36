#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "scene/tree.h"

/* Words and numbers, which YAML reads as they are. */
static bool is_plain(const char *text)
{
    static const char *const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 ._+-/";
    return *text != '\0' && strspn(text, letters) == strlen(text) && *text != ' ' && text[strlen(text) - 1] != ' ' &&
           strcmp(text, "-") != 0 && strncmp(text, "- ", 2) != 0 && strncmp(text, "---", 3) != 0;
}

static void put_scalar(FILE *stream, const ShvNode *node)
{
    if (node->null || is_plain(node->text)) {
        shv_print(stream, "%s", node->null ? "null" : node->text);
        return;
    }
    shv_print(stream, "'");
    for (const char *c = node->text; *c; c++) shv_print(stream, *c == '\'' ? "''" : "%c", *c == '\n' ? ' ' : *c);
    shv_print(stream, "'");
}

static void put_node(FILE *stream, const ShvNode *node)
{
    const bool list = node->kind == SHV_NODE_LIST;
    if (node->kind == SHV_NODE_SCALAR) {
        put_scalar(stream, node);
        return;
    }
    shv_print(stream, list ? "[" : "{");
    for (const ShvEntry *entry = node->first; entry; entry = entry->next) {
        if (entry != node->first) shv_print(stream, ", ");
        if (entry->key) put_scalar(stream, entry->key);
        if (entry->key) shv_print(stream, ": ");
        put_node(stream, entry->value);
    }
    shv_print(stream, list ? "]" : "}");
}

const char *shv_tree_text(ShvPool *pool, const ShvNode *node)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (stream) put_node(stream, node);
    pool->failed |= !stream || fclose(stream) != 0;
    const char *copy = pool->failed ? NULL : shv_pool_text(pool, text, length);
    free(text);
    return copy;
}

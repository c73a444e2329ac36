#include "base/names.h"

#include <string.h>

enum { LONGEST = 63 };

static int lower(char c)
{
    return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c;
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

/* Edit distance where no part is edited twice (optimal string alignment); three rows of the usual table. */
static int edit_distance(const char *a, int la, const char *b, int lb)
{
    int rows[3][LONGEST + 1];
    for (int j = 0; j <= lb; j++) rows[0][j] = j;
    for (int i = 1; i <= la; i++) {
        int *row = rows[i % 3];
        const int *above = rows[(i + 2) % 3], *two_above = rows[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= lb; j++) {
            const int ca = lower(a[i - 1]), cb = lower(b[j - 1]);
            row[j] = smaller(smaller(above[j], row[j - 1]) + 1, above[j - 1] + (ca != cb));
            if (i > 1 && j > 1 && ca == lower(b[j - 2]) && cb == lower(a[i - 2]))
                row[j] = smaller(row[j], two_above[j - 2] + 1);
        }
    }
    return rows[la % 3][lb];
}

static int begins_with(const char *text, const char *word, int length)
{
    for (int i = 0; i < length; i++)
        if (text[i] == '\0' || lower(text[i]) != lower(word[i])) return 0;
    return 1;
}

const char *shv_nearest_name(const char *word, const char *const *candidates, size_t n)
{
    const size_t word_length = strlen(word);
    if (word_length == 0 || word_length > LONGEST) return NULL;
    const int length = (int)word_length, limit = (length + 1) / 3;
    const char *nearest = NULL, *longer = NULL;
    int best = limit + 1;
    for (size_t k = 0; k < n; k++) {
        const size_t candidate_length = strlen(candidates[k]);
        if (candidate_length > LONGEST) continue;
        const int distance = edit_distance(word, length, candidates[k], (int)candidate_length);
        if (distance < best) {
            best = distance;
            nearest = candidates[k];
        }
        if (!longer && length >= 3 && begins_with(candidates[k], word, length)) longer = candidates[k];
    }
    return nearest ? nearest : longer;
}

/* Suggestions for misspelt names. */
#ifndef SHV_BASE_NAMES_H
#define SHV_BASE_NAMES_H

#include <stddef.h>

/* The candidate that `word` most likely stands for, or NULL when none is near: edit distance (insert, delete,
   replace, swap neighbours; Damerau and Levenshtein) of at most a third of the word, upper and lower case alike;
   else the first candidate that begins with the word (at least three letters). The first of equals wins. Words
   beyond 63 bytes are not compared. */
const char *shv_nearest_name(const char *word, const char *const *candidates, size_t n);

#endif

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "stability/suite.h"

/* One expectation against what was found. */
typedef struct Trial {
    ShvSuite *suite;
    ShvSuiteCase *item;
    const char *text;
    bool holds;
    char figure[192];
} Trial;

static ShvStatus bad(const Trial *trial, const char *what, ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT, "%s: `expect: %s` %s", trial->item->path, trial->text, what);
}

static bool begins_with(const char *text, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(text, word, length) == 0 && (text[length] == ' ' || text[length] == '\0');
}

static const char *after(const char *text)
{
    text += strcspn(text, " ");
    return text + strspn(text, " ");
}

static void say(Trial *trial, bool holds, const char *figure)
{
    trial->holds = holds;
    shv_format(trial->figure, sizeof trial->figure, "%s", figure);
}

static void try_message(Trial *trial, bool before_it_begins)
{
    const ShvSuiteFound *found = &trial->item->found;
    const char *part = after(trial->text);
    const char *place = strstr(found->message, part);
    const bool right = found->status != SHV_OK && found->begun != before_it_begins && place;
    if (right)
        say(trial, true, before_it_begins ? "refused so" : "stopped so");
    else if (found->status == SHV_OK)
        say(trial, false, "it ran to its end");
    else
        say(trial, false, found->message);
}

/* ---- figures ---- */

/* Runs another scene of the folder for comparison. */
static ShvStatus value_of_file(Trial *trial, const char *file, int measure, double *value, ShvError *error)
{
    char path[1024];
    ShvSuiteFound *other = shv_allocate(trial->suite->options.memory, SHV_PART_RECORD, 1, sizeof *other);
    if (!other) return shv_fail_memory(error, "a run to compare with", sizeof *other);
    shv_format(path, sizeof path, "%s/%s", trial->suite->folder, file);
    ShvStatus status = shv_suite_measure(other, path, "", &trial->suite->options, error);
    if (status == SHV_OK && other->status != SHV_OK)
        status =
            shv_fail(error, SHV_BAD_INPUT, "%s, which another case is compared with, fails: %s", path, other->message);
    *value = other->values[measure];
    shv_release(other);
    return status;
}

/* VALUE [of FILE] [within X [absolute]] */
typedef struct Bound {
    double value, within;
    bool has_within;
} Bound;

static ShvStatus read_bound(Trial *trial, const char *text, int measure, Bound *bound, ShvError *error)
{
    char *end = NULL;
    bound->value = shv_text_to_double(text, &end);
    if (end == text) return bad(trial, "lacks a number", error);
    text = end + strspn(end, " ");
    if (begins_with(text, "of")) {
        char file[128];
        double value = 0.0;
        text = after(text);
        shv_format(file, sizeof file, "%.*s", (int)strcspn(text, " "), text);
        SHV_TRY(value_of_file(trial, file, measure, &value, error));
        bound->value *= value;
        text = after(text);
    }
    bound->within = 0.0;
    bound->has_within = begins_with(text, "within");
    if (bound->has_within) {
        text = after(text);
        bound->within = shv_text_to_double(text, &end);
        if (end == text) return bad(trial, "lacks a number after `within`", error);
        text = end + strspn(end, " ");
        if (begins_with(text, "absolute"))
            text = after(text);
        else
            bound->within *= fabs(bound->value);
    }
    return *text ? bad(trial, "has words at its end that are not understood", error) : SHV_OK;
}

static ShvStatus try_figure(Trial *trial, ShvError *error)
{
    const size_t length = strcspn(trial->text, " ");
    const int measure = shv_suite_measure_number(trial->text, length);
    if (measure < 0) return bad(trial, "names no measure", error);
    const char *sign = after(trial->text);
    Bound bound = {0.0, 0.0, false};
    SHV_TRY(read_bound(trial, after(sign), measure, &bound, error));
    const double value = trial->item->found.values[measure];
    char figure[96];
    shv_format(figure, sizeof figure, "%.*s %.6g", (int)length, trial->text, value);
    bool holds = false;
    if (begins_with(sign, "<"))
        holds = value < bound.value;
    else if (begins_with(sign, "<="))
        holds = value <= bound.value;
    else if (begins_with(sign, ">"))
        holds = value > bound.value;
    else if (begins_with(sign, ">="))
        holds = value >= bound.value;
    else if (begins_with(sign, "="))
        holds = fabs(value - bound.value) <= bound.within;
    else
        return bad(trial, "lacks one of < <= > >= =", error);
    if (holds && bound.has_within)
        shv_format(figure, sizeof figure, "%.*s %.6g (off %.1e)", (int)length, trial->text, value,
                   fabs(value - bound.value));
    say(trial, holds && (trial->item->found.status == SHV_OK || trial->item->found.begun), figure);
    return SHV_OK;
}

static ShvStatus try_hash(Trial *trial, ShvError *error)
{
    if (strcmp(trial->text, "hash = first") != 0) return bad(trial, "is not `hash = first`", error);
    const ShvSuiteCase *first = &trial->suite->cases[trial->item->first];
    if (first == trial->item || !first->has_run) return bad(trial, "has no earlier case in its file", error);
    const bool equal = first->found.hash == trial->item->found.hash && first->found.status == trial->item->found.status;
    say(trial, equal, equal ? "same bits" : "other bits");
    return SHV_OK;
}

static ShvStatus try_one(Trial *trial, ShvError *error)
{
    const ShvSuiteFound *found = &trial->item->found;
    trial->holds = false;
    if (begins_with(trial->text, "finishes")) {
        const bool right = found->status == SHV_OK && found->finite;
        say(trial, right, right ? "finished" : found->status == SHV_OK ? "not finite" : found->message);
    } else if (begins_with(trial->text, "told")) {
        const bool right = found->status == SHV_OK ? found->finite : found->status == SHV_DIVERGED;
        say(trial, right && (found->status == SHV_OK || found->message[0]),
            found->status == SHV_OK ? "finished" : found->message);
    } else if (begins_with(trial->text, "refused")) {
        try_message(trial, true);
    } else if (begins_with(trial->text, "stops")) {
        try_message(trial, false);
    } else if (begins_with(trial->text, "hash")) {
        return try_hash(trial, error);
    } else {
        return try_figure(trial, error);
    }
    return SHV_OK;
}

static void append(char *text, const char *part)
{
    const size_t length = strlen(text);
    shv_format(text + length, SHV_SUITE_TEXT - length, "%s%s", length ? "; " : "", part);
}

ShvStatus shv_suite_judge(ShvSuite *suite, int32_t index, ShvError *error)
{
    ShvSuiteCase *item = &suite->cases[index];
    ShvSuiteRow *row = &item->row;
    bool holds = true;
    for (int i = 0; i < item->expectation_count; i++) {
        Trial trial = {.suite = suite, .item = item, .text = item->expectations[i]};
        SHV_TRY(try_one(&trial, error));
        append(row->found, trial.figure);
        holds &= trial.holds;
    }
    row->verdict = holds ? SHV_SUITE_PASS : row->explained[0] ? SHV_SUITE_EXPLAINED : SHV_SUITE_MISS;
    return SHV_OK;
}

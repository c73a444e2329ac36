/* One text file of an export: written beside its place, and put there when it is complete. */
#ifndef SHV_EXPORT_OUTPUT_H
#define SHV_EXPORT_OUTPUT_H

#include <stdio.h>

#include "shiver/export.h"

typedef struct ShvOutput {
    char *path, *temporary;
    FILE *stream;
} ShvOutput;

/* prefix + suffix; the caller releases it. NULL: out of memory. */
char *shv_output_path(const ShvExportOptions *options, const char *prefix, const char *suffix);
/* A text for XML, its control characters made spaces; the caller releases it. NULL: out of memory. */
char *shv_output_escaped(const ShvExportOptions *options, const char *text);
/* SHV_BAD_INPUT when one of the files prefix + suffix may not be written. */
ShvStatus shv_output_check(const ShvExportOptions *options, const char *prefix, const char *const *suffixes, int count,
                           ShvError *error);
/* On failure `output` is zeroed and nothing is left behind. */
ShvStatus shv_output_open(ShvOutput *output, const ShvExportOptions *options, const char *prefix, const char *suffix,
                          ShvError *error);
/* Puts the file in its place when `status` is SHV_OK and everything could be written, else removes it; returns the first
   of both failures. `output` may be zeroed. */
ShvStatus shv_output_close(ShvOutput *output, const ShvExportOptions *options, ShvStatus status, ShvError *error);

/* A whole text file at once, from what `put` writes. */
ShvStatus shv_output_write(const ShvExportOptions *options, const char *path,
                           void (*put)(const void *data, FILE *stream), const void *data, ShvError *error);

/* The same for files prefix + name, from what `put` writes of each by its index. */
ShvStatus shv_output_write_all(const ShvExportOptions *options, const char *prefix, const char *const *names, int count,
                               void (*put)(const void *data, int index, FILE *stream), const void *data,
                               ShvError *error);

/* Removes a file of an export of several that has failed. */
void shv_output_withdraw(const char *prefix, const char *suffix);

/* Room for a number as text. */
enum { SHV_OUTPUT_NUMBER = 32 };
/* The shortest of 15, 16 and 17 digits that gives the same number back; and that as a field behind a comma, empty where the
   number is not finite. */
void shv_output_format(char text[SHV_OUTPUT_NUMBER], double value);
void shv_output_number(FILE *stream, double value);
/* A text as a field of CSV, quoted where it has to be (RFC 4180). */
void shv_output_field(FILE *stream, const char *text);

/* Members of a JSON object, one after the other with commas between; starts from its stream, behind the brace. */
typedef struct ShvMembers {
    FILE *stream;
    bool any;
} ShvMembers;
/* The key alone, for a value that the caller writes. */
void shv_member_key(ShvMembers *members, const char *name);
void shv_member_text(ShvMembers *members, const char *name, const char *text);
/* null where the number is not finite. */
void shv_member_number(ShvMembers *members, const char *name, double value);
void shv_member_flag(ShvMembers *members, const char *name, bool flag);

/* A number of a struct by its name. */
typedef struct ShvNumberField {
    const char *name;
    size_t offset;
} ShvNumberField;
double shv_number_of(const void *item, const ShvNumberField *field);
void shv_member_fields(ShvMembers *members, const void *item, const ShvNumberField *fields, int count);

/* Whether a frame is asked for. */
bool shv_output_takes(const ShvExportOptions *options, const ShvRunFile *file, int64_t frame);

/* The options given, checked: the defaults for NULL. */
ShvStatus shv_export_options(const ShvExportOptions *given, ShvExportOptions *options, ShvError *error);

#endif

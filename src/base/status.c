#include "shiver/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

const char *shv_status_name(ShvStatus status)
{
    switch (status) {
    case SHV_OK:
        return "ok";
    case SHV_BAD_INPUT:
        return "bad input";
    case SHV_NO_MEMORY:
        return "no memory";
    case SHV_FILE_ERROR:
        return "file error";
    case SHV_DIVERGED:
        return "diverged";
    case SHV_INTERRUPTED:
        return "interrupted";
    case SHV_UNSUPPORTED:
        return "unsupported";
    }
    return "unknown status";
}

ShvStatus shv_fail(ShvError *error, ShvStatus status, const char *format, ...)
{
    if (!error) return status;
    /* Built aside, because the old message may be among the arguments. */
    char message[sizeof error->message];
    va_list arguments;
    va_start(arguments, format);
    shv_format_list(message, sizeof message, format, arguments);
    va_end(arguments);
    error->status = status;
    memcpy(error->message, message, sizeof message);
    return status;
}

ShvStatus shv_fail_within(ShvError *error, ShvStatus status, const char *context, ...)
{
    if (!error) return status;
    char before[sizeof error->message];
    va_list arguments;
    va_start(arguments, context);
    shv_format_list(before, sizeof before, context, arguments);
    va_end(arguments);
    return shv_fail(error, status, "%s: %s", before, error->message);
}

/* What every test program includes: CMocka with its required headers, and comparisons of doubles. */
#ifndef SHV_TESTS_CHECK_H
#define SHV_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* |a − b| ≤ tolerance, with the values in the message. */
#define check_near(a, b, tolerance)                                                                                    \
    do {                                                                                                               \
        const double check_a_ = (a), check_b_ = (b), check_t_ = (tolerance);                                           \
        if (!(fabs(check_a_ - check_b_) <= check_t_))                                                                  \
            fail_msg("%s = %.17g, expected %.17g within %g (off by %g)", #a, check_a_, check_b_, check_t_,             \
                     check_a_ - check_b_);                                                                             \
    } while (0)

/* The status is SHV_OK, or the message of `error` is shown. */
#define check_ok(expression, error)                                                                                    \
    do {                                                                                                               \
        if ((expression) != SHV_OK) fail_msg("%s: %s", #expression, (error).message);                                  \
    } while (0)

/* A failure with this status whose message contains `part`. */
#define check_fails(expression, expected, error, part)                                                                 \
    do {                                                                                                               \
        const ShvStatus check_s_ = (expression);                                                                       \
        if (check_s_ != (expected)) fail_msg("%s gave status %d: %s", #expression, (int)check_s_, (error).message);    \
        if (!strstr((error).message, (part))) fail_msg("message lacks '%s': %s", (part), (error).message);             \
    } while (0)

#endif

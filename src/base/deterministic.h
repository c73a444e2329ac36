/* Elementary functions whose bits do not depend on the processor (the C library picks variants of exp, log,
   pow, sin and cos at run time). Relative error below 4e-15 (where the result is a normal number); special
   values as in the C library unless stated. */
#ifndef SHV_BASE_DETERMINISTIC_H
#define SHV_BASE_DETERMINISTIC_H

#define SHV_PI     3.14159265358979323846
#define SHV_DEGREE (SHV_PI / 180.0) /* in radians */

double shv_exp(double x);
double shv_log(double x);
/* x^a for x ≥ 0; small whole and half exponents by multiplication and square root. 0^0 = 1. NaN for x < 0, except
   x^0 = 1. */
double shv_power(double x, double a);
/* Of x ≥ 0. That of 8 x is twice that of x to the bit: a length from a volume does not depend on the unit. */
double shv_cube_root(double x);
/* Radians; NaN beyond |x| = 2^40. */
double shv_sin(double x);
double shv_cos(double x);
double shv_acos(double x);

#endif

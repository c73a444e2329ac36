/* Elementary functions whose bits do not depend on the processor (the C library picks variants of exp, log,
   pow, sin and cos at run time). Relative error below 4e-15. */
#ifndef SHV_BASE_DETERMINISTIC_H
#define SHV_BASE_DETERMINISTIC_H

double shv_exp(double x);
double shv_log(double x);
/* x^a for x ≥ 0; small whole and half exponents by multiplication and square root. 0^0 = 1. */
double shv_power(double x, double a);
double shv_sin(double x);
double shv_cos(double x);
double shv_acos(double x);

#endif

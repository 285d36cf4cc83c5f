// SPDX-License-Identifier: MIT
// More functions like those of portable_math.h, only for loaded controllers and libraries: coopdyn's own code
// calls none of them. Pure; any thread.
#pragma once

namespace coopdyn::portable {

double Sinh(double x);
double Cosh(double x);
double Tanh(double x);
double Exp2(double x);
double Exp10(double x);
double Expm1(double x);
double Log2(double x);
double Log10(double x);
double Log1p(double x);

}  // namespace coopdyn::portable

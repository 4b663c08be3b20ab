#include "metrics/metrics.h"

#include <float.h>
#include <math.h>

// Returns ln(Γ(a + 1/2) / Γ(a)). From a = 50 on it uses the asymptotic series in 1/a (from
// Stirling's; DLMF 5.11.13), whose first omitted term is below 1e-14 there: for large a the
// difference of two log-gamma functions would lose all digits by cancellation.
static double log_gamma_step(double a)
{
    if (a < 50)
        return lgamma(a + 0.5) - lgamma(a);
    double inverse = 1 / a, square = inverse * inverse;
    return 0.5 * log(a) - inverse * (1.0 / 8 - square * (1.0 / 192 - square / 640));
}

// Evaluates the continued fraction of the incomplete beta function (DLMF 8.17.22) from the front by
// the modified method of Lentz (1976; Thompson and Barnett 1986). It converges fast for x < (a + 1)
// / (a + b + 2), in about sqrt(max(a, b)) steps.
static double beta_fraction(double x, double a, double b)
{
    const double tiny = DBL_MIN / DBL_EPSILON; // replaces a denominator of 0
    double c = 1, d = 1 - (a + b) * x / (a + 1);
    d = 1 / (fabs(d) < tiny ? tiny : d);
    double value = d;
    for (double m = 1;; m++) {
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double factor = 1;
        for (int i = 0; i < 2; i++) {
            double term = i == 0 ? even : odd;
            d = 1 + term * d;
            d = 1 / (fabs(d) < tiny ? tiny : d);
            c = 1 + term / c;
            c = fabs(c) < tiny ? tiny : c;
            factor *= c * d;
        }
        value *= factor;
        if (fabs(factor - 1) <= 4 * DBL_EPSILON || m > 1e6)
            return value;
    }
}

// Returns a probability of Student's t with n degrees of freedom, where `odds` is t^2 / n (DLMF
// 8.17 with x = n / (n + t^2)): P(T > t) = I_x(n/2, 1/2) / 2 if `tail` is set, otherwise P(0 < T <
// t) = I_{1-x}(1/2, n/2) / 2. Each is accurate where it is small.
static double t_probability(double odds, double degrees, bool tail)
{
    double x = 1 / (1 + odds), y = odds / (1 + odds);
    double a = degrees / 2, b = 0.5;
    // The factor x^a y^b / B(a, b), with B(a, 1/2) = Γ(a) Γ(1/2) / Γ(a + 1/2) and Γ(1/2)^2 = pi.
    double front = exp(log_gamma_step(a) - a * log1p(odds)) * sqrt(y / acos(-1.0));
    // By the symmetry I_x(a, b) = 1 - I_y(b, a), the fraction that converges can be chosen.
    bool direct = x < (a + 1) / (a + b + 2);
    double part = direct ? front * beta_fraction(x, a, b) / a : front * beta_fraction(y, b, a) / b;
    return 0.5 * (direct == tail ? part : 1 - part);
}

double stats_t_quantile(double p, double degrees_of_freedom)
{
    if (!(p > 0 && p < 1) || !(degrees_of_freedom >= 1) || isinf(degrees_of_freedom))
        return NAN;
    if (p == 0.5)
        return 0;
    // Solves for the smaller one of P(T > t) and P(0 < T < t), both of which are exact here.
    bool tail = fabs(p - 0.5) > 0.25;
    double wanted = tail ? fmin(p, 1 - p) : fabs(p - 0.5);
    // Bisects ln(t^2 / n). The range contains the solution for every p that a double can represent.
    double low = log(DBL_MIN), high = log(DBL_MAX);
    while (high - low > 1e-13 * fmax(1, fabs(low))) {
        double middle = 0.5 * (low + high);
        double probability = t_probability(exp(middle), degrees_of_freedom, tail);
        bool beyond = tail ? probability < wanted : probability > wanted;
        *(beyond ? &high : &low) = middle;
    }
    double t = sqrt(exp(0.5 * (low + high)) * degrees_of_freedom);
    return p < 0.5 ? -t : t;
}

void stats_mean_variance(const double *values, size_t count, double *mean, double *variance)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    *mean = count > 0 ? sum / (double)count : NAN;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - *mean) * (values[i] - *mean);
    *variance = count > 1 ? squares / (double)(count - 1) : NAN;
}

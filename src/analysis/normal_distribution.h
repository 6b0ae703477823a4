// The standard normal distribution Φ and its density φ, with relative errors below 1e-12 from tail
// to tail, also where Φ itself underflows.
#ifndef LACUNA_ANALYSIS_NORMAL_DISTRIBUTION_H_
#define LACUNA_ANALYSIS_NORMAL_DISTRIBUTION_H_

namespace lacuna {

// ln Φ(z)
double LogNormal(double z);

// ln(2 Φ(z)): the factor by which a prior that is truncated at 0 changes the evidence of an amount
// that is z standard deviations above 0. Near z = 0, where it vanishes, its absolute error is below
// 1e-15.
double LogTwiceNormal(double z);

// φ(z) / Φ(z): the derivative of ln Φ, and the mean of a standard normal number above −z.
double InverseMillsRatio(double z);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_NORMAL_DISTRIBUTION_H_

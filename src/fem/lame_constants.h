// The Lamé constants λ, μ of an isotropic elastic solid, and their derivatives with respect to
// Young's modulus E and Poisson's ratio ν:
//   λ = E ν / ((1 + ν)(1 − 2ν)),    μ = E / (2 (1 + ν)),    −1 < ν < ½.
#ifndef LACUNA_FEM_LAME_CONSTANTS_H_
#define LACUNA_FEM_LAME_CONSTANTS_H_

namespace lacuna {

// The constants, or their derivatives in the unit that follows.
struct LameConstants {
  double lambda = 0;  // Pa
  double mu = 0;      // Pa, the shear modulus
};

// (λ, μ) for E in Pa.
inline LameConstants LameFromYoung(double young_modulus, double poisson_ratio) {
  const double nu = poisson_ratio;
  return {young_modulus * nu / ((1 + nu) * (1 - 2 * nu)), young_modulus / (2 * (1 + nu))};
}

// ∂(λ, μ)/∂E, dimensionless; it does not depend on E.
inline LameConstants LameByYoungModulus(double poisson_ratio) {
  return LameFromYoung(1, poisson_ratio);
}

// ∂(λ, μ)/∂ν, Pa.
inline LameConstants LameByPoissonRatio(double young_modulus, double poisson_ratio) {
  const double nu = poisson_ratio;
  const double denominator = (1 + nu) * (1 - 2 * nu);
  return {young_modulus * (1 + 2 * nu * nu) / (denominator * denominator),
          -young_modulus / (2 * (1 + nu) * (1 + nu))};
}

}  // namespace lacuna

#endif  // LACUNA_FEM_LAME_CONSTANTS_H_

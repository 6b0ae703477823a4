// The material of a model in the input format of Abaqus and CalculiX, and what becomes of the parts
// of the model there.
//
// Small-strain limits follow from E and ν: μ = E/(2(1+ν)), λ = Eν/((1+ν)(1−2ν)), K = λ + 2μ/3.
//  * Linear elasticity is *ELASTIC in steps without NLGEOM.
//  * St. Venant–Kirchhoff is *ELASTIC in steps with NLGEOM. CalculiX relates the second
//    Piola–Kirchhoff stress to the Green–Lagrange strain (G. Dhondt, CalculiX CrunchiX User's
//    Manual, "Linear elastic materials for large strains"), which is the same law; Abaqus uses the
//    logarithmic strain, which agrees to first order in the strain.
//  * The corotational law agrees with both to first order in the strain, at any rotation.
//  * The neo-Hookean law ψ = μ/2 (F:F − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)² is not that of
//    *HYPERELASTIC, NEO HOOKE, ψ = C10 (J^(−2/3) F:F − 3) + (J − 1)²/D1. With C10 = μ/2 and D1 =
//    2/K the energies agree to second order in the strain, hence the stresses to first order: with
//    J = 1 + d and F:F − 3 = 2d + O(ε²), J^(−2/3) F:F − 3 = (F:F − 3) − 2d + d²/3 + O(ε³), so that
//    the coefficient of d² is μ/6 + K/2 = (λ + μ)/2, as in ψ. Both are the same where J = 1.
//  * Rayleigh damping: α M is that of mass damping; β C on the rate of the Green–Lagrange strain is
//    β K for small strains and slow rotations: where a part rotates at ω, K v contains ω × f of its
//    elastic forces f. Its moduli must be proportional to those of the material. CalculiX
//    multiplies K with the velocities of the free nodes only: those with a prescribed motion count
//    as if they were at rest.
//  * Branches m, ν_b, τ of a Prony series (Abaqus only): g = μ_b/(μ + Σμ_b), k = K_b/(K + ΣK_b).
#ifndef LACUNA_EXCHANGE_INP_MATERIAL_H_
#define LACUNA_EXCHANGE_INP_MATERIAL_H_

#include <string>

#include "exchange/counterpart.h"

namespace lacuna {

enum class InpDialect {
  kCalculix,
  // For CalculiX, whose implicit dynamics has no lumped masses of elements: the masses of
  // PortableModel::node_mass as point masses, and elements almost without mass.
  kCalculixPointMasses,
  kAbaqus
};

// A number of at most 20 characters, which both programs read, with 13 significant digits.
std::string InpNumber(double value);

Counterparts InpCounterparts(const PortableModel& model, InpDialect dialect);

// Whether the steps have NLGEOM.
bool IsGeometricallyNonlinear(const PortableModel& model);

// *MATERIAL with all its options, called LACUNA. CHECKs that the elasticity law has a counterpart.
std::string InpMaterial(const PortableModel& model, InpDialect dialect);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_INP_MATERIAL_H_

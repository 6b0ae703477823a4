// Writes a model as an input file of FEBio (.feb, version 4.0; S. A. Maas, B. J. Ellis, G. A.
// Ateshian, J. A. Weiss, FEBio: Finite Elements for Biomechanics, J. Biomech. Eng. 134, 2012; FEBio
// User Manual 4).
//
// The file holds the mesh (tet4 or tet10, whose node order is that of TetMesh), a node set for each
// region of the recording, the material, and two steps as in an .inp file: the equilibrium at the
// start of the motion, then the motion. The first step lasts 1 s, and a thousand times the longest
// relaxation time where there are viscoelastic branches, which FEBio does not let relax otherwise.
// SI units; all digits are written.
//
// Laws, with λ and μ from E and ν:
//  * "isotropic elastic" is Hooke's law between the second Piola–Kirchhoff stress and the
//    Green–Lagrange strain, which is St. Venant–Kirchhoff.
//  * "neo-Hookean" is ψ = μ/2 (F:F − 3) − μ ln J + λ/2 (ln J)². With ln J = d − d²/2 + O(d³) and
//    d = J − 1, this is μ/2 (F:F − 3) − μ d + (λ + μ)/2 d² + O(d³), Lacuna's law to second order in
//    d.
//  * "viscoelastic" multiplies the rate of the elastic stress by 1 + Σ g exp(−t/τ), g = m/E, where
//    the branch has the Poisson ratio of the material.
#ifndef LACUNA_EXCHANGE_FEB_WRITER_H_
#define LACUNA_EXCHANGE_FEB_WRITER_H_

#include <string>

#include "exchange/counterpart.h"

namespace lacuna {

Counterparts FebCounterparts(const PortableModel& model);

// The text of the file. Parts that FebCounterparts lists as missing are left out and named in the
// comment at the top. Throws InputError where the elasticity law has no counterpart.
std::string FebText(const PortableModel& model);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_FEB_WRITER_H_

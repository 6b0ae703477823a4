// Detection of nodes whose mass is not positive.
//
// Effects may add inertia of either sign to the lumped masses M of a body, such as a negative mass
// that stands for a void. Where more mass is removed than there is, no such body exists: the
// equation of motion (M + A) a = …, with A = −∂f/∂a, has no stable solution, and the weight acts
// upwards.
#ifndef LACUNA_FEM_MISSING_MASS_H_
#define LACUNA_FEM_MISSING_MASS_H_

#include <string>

#include "fem/model.h"

namespace lacuna {

// Returns an empty text if M + A is positive at all nodes of the model at rest, and otherwise a
// sentence that names the effect that removes most at the worst of the nodes, its size, the place
// and the masses there.
std::string DescribeMissingMass(const Model& model);

}  // namespace lacuna

#endif  // LACUNA_FEM_MISSING_MASS_H_

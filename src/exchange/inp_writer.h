// Writes a model as an input file of CalculiX or Abaqus.
//
// The file holds the mesh (C3D4 or C3D10, whose node order is that of TetMesh), a node set for each
// region of the recording, the material (inp_material.h), and two steps: the equilibrium of the
// held body at the start of the motion, from total time 0 to 1 s, and the motion from 1 s on.
// Forces and prescribed motions are tables over the total time. SI units. Node and element numbers
// are those of the mesh plus 1.
//
// With kCalculixPointMasses each node has an element of its own with a point mass, whose number is
// that of the node plus the number of tetrahedra, and its weight is a force on the node.
//
// Coordinates are written without exponent, with all digits that a double needs. CalculiX reads the
// first 20 characters of a number, so that it loses digits below 1e-17 m and never an exponent.
#ifndef LACUNA_EXCHANGE_INP_WRITER_H_
#define LACUNA_EXCHANGE_INP_WRITER_H_

#include <string>
#include <vector>

#include "exchange/inp_material.h"

namespace lacuna {

// The duration of the first step, s, after which the motion begins.
inline constexpr double kInpRampTime = 1;

// The names of node sets for these parts: capital letters, digits and underscores, beginning with a
// letter, unique and at most 80 characters long.
std::vector<std::string> InpSetNames(const std::vector<NamedNodes>& parts);

// The text of the file. Parts that InpCounterparts lists as missing are left out and named in the
// comment at the top. Throws InputError where the elasticity law itself has no
// counterpart.
std::string InpText(const PortableModel& model, InpDialect dialect);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_INP_WRITER_H_

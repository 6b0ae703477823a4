// Writes a model as a scene of a program for interactive simulation or animation: SOFA (a Python
// scene), MuJoCo (MJCF) and USD (a TetMesh). They have linear tetrahedra only, so that of quadratic
// elements the corner nodes are kept. SI units.
//
// Sources: SOFA documentation, TetrahedronHyperelasticityFEMForceField and
// TetrahedronFEMForceField; MuJoCo XML reference, flexcomp; USD, UsdGeomTetMesh.
#ifndef LACUNA_EXCHANGE_SCENE_WRITERS_H_
#define LACUNA_EXCHANGE_SCENE_WRITERS_H_

#include <string>

#include "exchange/counterpart.h"

namespace lacuna {

// The model on the linear elements of the corner nodes, with regions, grips and loads on the nodes
// that are left, and without the force of a hold. A midpoint gives half of its share of a load to
// each end of its edge. A linear model is returned unchanged.
PortableModel WithLinearElements(const PortableModel& model);

// What WithLinearElements loses of a quadratic model.
void AddLostMidpoints(const PortableModel& model, Counterparts* parts);

// The texts name the mesh file "model.msh" (Gmsh 2.2), which is that of WithLinearElements; the USD
// text holds the mesh itself, with points in single precision.
Counterparts SofaCounterparts(const PortableModel& model);
std::string SofaText(const PortableModel& model);

Counterparts MujocoCounterparts(const PortableModel& model);
std::string MujocoText(const PortableModel& model);

Counterparts UsdCounterparts(const PortableModel& model);
std::string UsdText(const PortableModel& model);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_SCENE_WRITERS_H_

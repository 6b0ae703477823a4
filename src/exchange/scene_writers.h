// Writes a model as a scene of a program for interactive simulation or animation: SOFA (a Python
// scene), MuJoCo (MJCF) and USD (a TetMesh). They have linear tetrahedra only, so that of quadratic
// elements the corner nodes are kept. SI units.
//
// Sources: SOFA's documentation of TetrahedronFEMForceField, and its code from v24.06, the first
// version that has all components under the names that are written, to v26.06:
// material/NeoHookean.h (ψ = μ/2 (F:F − 3) − μ ln J + λ/2 (ln J)², as in FEBio; see feb_writer.h),
// LinearMovementProjectiveConstraint.inl and EulerImplicitSolver.cpp; MuJoCo XML reference,
// flexcomp; USD 24.08, UsdGeomTetMesh, UsdGeomSubset and UsdPhysics. The deformable body follows
// the proposal "Deformable Body Physics in USD" (pull request 111 of
// PixarAnimationStudios/OpenUSD-proposals, as of commit 584939b):
// PhysicsVolumeDeformableMaterialAPI has Young's modulus, Poisson's ratio and the density, a
// quarter of the mass of an element belongs to each of its points as in Lacuna, and a
// PhysicsAttachment ties the nodes of a grip to a frame. No prim has PhysicsCollisionAPI, so that
// nothing collides.
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

// What is lost of a model whose motion begins with the equilibrium of the held body, or is
// quasi-static, since a scene begins with the rest shape and has inertia.
void AddLostStart(const PortableModel& model, Counterparts* parts);

// The texts name the mesh file "model.msh", which is that of WithLinearElements; the USD text holds
// the mesh itself, with points in single precision. The functions …Text throw InputError where the
// elasticity law has no counterpart.
Counterparts SofaCounterparts(const PortableModel& model);
std::string SofaText(const PortableModel& model);

Counterparts MujocoCounterparts(const PortableModel& model);
std::string MujocoText(const PortableModel& model);

// The regions are subsets of the points; the values of all effects are custom attributes.
Counterparts UsdCounterparts(const PortableModel& model);
std::string UsdText(const PortableModel& model);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_SCENE_WRITERS_H_

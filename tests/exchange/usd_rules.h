// The rules of USD that concern what Lacuna writes. There is no package of usdchecker; these are
// its rules, those of the schemas that the file names, and those of the proposal for deformable
// bodies.
//
// Sources: pxr/usd/usdUtils/complianceChecker.py, usdGeom/schema.usda and usdPhysics/schema.usda of
// OpenUSD 24.08; "Deformable Body Physics in USD", pull request 111 of
// PixarAnimationStudios/OpenUSD-proposals, as of commit 584939b.
#ifndef LACUNA_TESTS_EXCHANGE_USD_RULES_H_
#define LACUNA_TESTS_EXCHANGE_USD_RULES_H_

#include <string>
#include <vector>

namespace lacuna {

// What in the text of a .usda file breaks a rule, one sentence each.
//  * Header, brackets and names are those of the text format; defaultPrim is an Xform at the root,
//    and upAxis, metersPerUnit, kilogramsPerUnit and the range of the time are given.
//  * Types of prims and API schemas are known. A property belongs to a schema of its prim, with the
//    type that is declared there, or is custom; its value has that type.
//  * Every relationship leads to a prim of the right type, material bindings are announced by
//    MaterialBindingAPI, and no Gprim or Material stands below a Gprim.
//  * TetMesh: indices in range, tetrahedra with positive volume in the order of "rightHanded", the
//    surface has exactly the outer faces, looking outwards, and `extent` is the bounding box.
//  * GeomSubset: a child of the mesh, indices in range and none twice, a type of its family.
//  * Deformable body: one mesh to simulate, a material with values in range; attachments have as
//    many coordinates as points; frames move rigidly, in ascending time.
std::vector<std::string> UsdFaults(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_USD_RULES_H_

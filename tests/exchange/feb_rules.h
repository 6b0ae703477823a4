// The rules of FEBio's input format 4.0, so far as they concern what Lacuna writes (FEBio User
// Manual 4, chapter 3, and the reader FEBioXML of FEBio 4.11).
#ifndef LACUNA_TESTS_EXCHANGE_FEB_RULES_H_
#define LACUNA_TESTS_EXCHANGE_FEB_RULES_H_

#include <string>
#include <vector>

namespace lacuna {

// What in the text of a .feb file breaks a rule, one sentence each.
//  * The file is well-formed XML with the root febio_spec of version 4.0.
//  * Sections stand once each and in the order that the manual recommends, Module first; the
//    required ones are there. (The reader itself insists on Module first and on MeshDomains before
//    MeshData.)
//  * Elements and attributes are known, since the reader stops at unknown ones, and the required
//    attributes are there.
//  * Identifiers count from 1 without a gap; names of sets and maps are unique.
//  * Elements are tet4 or tet10, with nodes of the mesh that enclose a positive volume.
//  * Every node set, map, material, part and load controller that is named exists.
//  * Values are numbers, words of the allowed list, or within the range of the parameter.
std::vector<std::string> FebFaults(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_FEB_RULES_H_

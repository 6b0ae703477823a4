// What the program was built from.
#ifndef LACUNA_RECORD_LIBRARY_VERSIONS_H_
#define LACUNA_RECORD_LIBRARY_VERSIONS_H_

#include <map>
#include <string>

namespace lacuna {

// "0.1.0"
std::string ProgramVersion();

// Library name → the version of its headers, for those on which numbers depend.
std::map<std::string, std::string> LibraryVersions();

}  // namespace lacuna

#endif  // LACUNA_RECORD_LIBRARY_VERSIONS_H_

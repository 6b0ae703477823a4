// The versions of the program and of the libraries that it was built with.
#ifndef LACUNA_RECORD_LIBRARY_VERSIONS_H_
#define LACUNA_RECORD_LIBRARY_VERSIONS_H_

#include <map>
#include <string>

namespace lacuna {

// The version of the program: "0.1.0".
std::string ProgramVersion();

// The header versions, by library name, of the libraries that can affect numerical results.
std::map<std::string, std::string> LibraryVersions();

}  // namespace lacuna

#endif  // LACUNA_RECORD_LIBRARY_VERSIONS_H_

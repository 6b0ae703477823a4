// The manual page of a program in the macros of man(7), with a section for each command.
#ifndef LACUNA_APP_MAN_PAGE_H_
#define LACUNA_APP_MAN_PAGE_H_

#include <string>

#include "app/described_command.h"

namespace lacuna {

// `version` is shown in the page's footer, e.g. "Lacuna 0.1.0".
std::string ManPage(const DescribedCommand& program, const std::string& version);

}  // namespace lacuna

#endif  // LACUNA_APP_MAN_PAGE_H_

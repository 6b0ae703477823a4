// Completion of a program's commands, options and their values in a shell. What an option or an
// argument takes is completed as a file unless its values are known.
#ifndef LACUNA_APP_COMPLETIONS_H_
#define LACUNA_APP_COMPLETIONS_H_

#include <string>

#include "app/described_command.h"

namespace lacuna {

// A script for share/bash-completion/completions/<program>. It needs bash alone.
std::string BashCompletion(const DescribedCommand& program);

// The function _<program> for a folder of zsh's fpath.
std::string ZshCompletion(const DescribedCommand& program);

}  // namespace lacuna

#endif  // LACUNA_APP_COMPLETIONS_H_

// What is generated from a program's command line when it is built: its manual page and the
// completion scripts of shells.
#ifndef LACUNA_APP_COMMAND_DOCUMENTS_H_
#define LACUNA_APP_COMMAND_DOCUMENTS_H_

namespace CLI {
class App;
}

namespace lacuna {

// Adds the hidden option --print-document man|bash|zsh, which prints one of them and ends the
// program. All other options and commands must have been added when the command line is parsed.
void AddDocumentOption(CLI::App* app);

}  // namespace lacuna

#endif  // LACUNA_APP_COMMAND_DOCUMENTS_H_

#include "app/man_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <sstream>

namespace lacuna {
namespace {

// Text without meaning to roff: a backslash begins an escape, a hyphen would become a dash that
// cannot be pasted into a shell, and a dot or an apostrophe at the start of a line is a request.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    const bool starts_line = escaped.empty() || escaped.back() == '\n';
    if (starts_line && (letter == '.' || letter == '\'')) escaped += "\\&";
    if (letter == '\\') {
      escaped += "\\e";
    } else if (letter == '-') {
      escaped += "\\-";
    } else {
      escaped += letter;
    }
  }
  return escaped;
}

std::string Upper(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::toupper(letter));
  return text;
}

// Lines that must keep their breaks are indented or have columns.
bool IsPreformatted(const std::string& text) { return text.find("   ") != std::string::npos; }

std::string Paragraph(const std::string& text) {
  if (IsPreformatted(text)) return ".nf\n" + Escaped(text) + "\n.fi\n";
  return Escaped(text) + "\n";
}

// "-o, --output TEXT", with the names in bold and the value in italics.
std::string Heading(const DescribedOption& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", Escaped(name));
  if (option.value.empty()) return names;
  return fmt::format("{}{}\\fI{}\\fR", names, names.empty() ? "" : " ", Escaped(option.value));
}

std::string List(const std::vector<DescribedOption>& options) {
  std::string text;
  for (const DescribedOption& option : options) {
    std::string meaning = option.description;
    if (!option.choices.empty())
      meaning += fmt::format(" (one of {})", fmt::join(option.choices, ", "));
    if (option.required && !option.names.empty()) meaning += " (required)";
    text += fmt::format(".TP\n{}\n{}\n", Heading(option), Escaped(meaning));
  }
  return text;
}

// One command, and then those inside it: "sweep", "sweep plan".
std::string CommandText(const DescribedCommand& command, const std::string& program,
                        const std::string& before) {
  const std::string path = before + command.name;
  std::string text =
      fmt::format(".SS {}\n{}.\n.PP\n\\fB{} {}\\fR\n", Escaped(path), Escaped(command.description),
                  Escaped(program), Escaped(before + Synopsis(command)));
  text += List(command.arguments) + List(command.options);
  if (!command.footer.empty()) text += ".PP\n" + Paragraph(command.footer);
  for (const DescribedCommand& inner : command.commands)
    text += CommandText(inner, program, path + " ");
  return text;
}

}  // namespace

std::string ManPage(const DescribedCommand& program, const std::string& version) {
  // The description, without its full stop, is what apropos(1) shows.
  std::string purpose = program.description;
  if (!purpose.empty() && purpose.back() == '.') purpose.pop_back();
  std::string text = fmt::format(".TH {} 1 \"\" \"{}\" \"User Commands\"\n",
                                 Upper(Escaped(program.name)), version);
  text += fmt::format(".SH NAME\n{} \\- {}\n", Escaped(program.name), Escaped(purpose));
  text += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR\n", Escaped(Synopsis(program)));
  text += ".SH OPTIONS\n" + List(program.arguments) + List(program.options);
  text += ".SH COMMANDS\n";
  for (const DescribedCommand& command : program.commands)
    text += CommandText(command, program.name, "");
  if (!program.footer.empty()) text += ".SH NOTES\n" + Paragraph(program.footer);
  return text;
}

}  // namespace lacuna

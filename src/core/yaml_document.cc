#include "core/yaml_document.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "core/field_path.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& file, const YAML::Mark& mark,
                       const std::string& message) {
  throw InputError(PositionOf(file, mark), message);
}

// Throws InputError for a repeated key, of which YAML-cpp would silently discard one value.
void RefuseRepeatedKeys(const YAML::Node& root, const std::filesystem::path& file) {
  std::vector<YAML::Node> open = {root};
  while (!open.empty()) {
    const YAML::Node current = open.back();
    open.pop_back();
    std::map<std::string, int> seen;
    for (const auto& entry : current) {
      if (current.IsMap()) {
        if (entry.first.IsScalar() && seen[entry.first.Scalar()]++ > 0)
          Fail(file, entry.first.Mark(), entry.first.Scalar() + ": is given twice");
        if (entry.second.IsMap() || entry.second.IsSequence()) open.push_back(entry.second);
      } else if (entry.IsMap() || entry.IsSequence()) {
        open.push_back(static_cast<const YAML::Node&>(entry));
      }
    }
  }
}

// Where the first node of a document stands.
class FirstNode : public YAML::EventHandler {
 public:
  const YAML::Mark& mark() const { return mark_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { Keep(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { Keep(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string&) override {
    Keep(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Keep(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Keep(mark);
  }
  void OnMapEnd() override {}

 private:
  void Keep(const YAML::Mark& mark) {
    if (mark_.is_null()) mark_ = mark;
  }
  YAML::Mark mark_ = YAML::Mark::null_mark();
};

YAML::Node Parse(const std::string& text, const std::filesystem::path& file) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
    // YAML::LoadAll() does not end for some damaged files.
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    FirstNode first, second;
    if (parser.HandleNextDocument(first) && parser.HandleNextDocument(second))
      Fail(file, second.mark(), "a second YAML document starts here; expected one per file");
  } catch (const YAML::ParserException& problem) {
    Fail(file, problem.mark, "is not valid YAML: " + problem.msg);
  }
  if (!root.IsMap()) {
    Fail(file, root.IsNull() ? YAML::Mark::null_mark() : root.Mark(),
         "expected a YAML mapping of \"key: value\" lines");
  }
  RefuseRepeatedKeys(root, file);
  return root;
}

// Removes the entries of `field`, and of everything below it, from the list of inserted fields.
void Forget(const std::string& field, YamlDocument* document) {
  auto& files = document->file_of_field;
  for (auto at = files.begin(); at != files.end();) {
    at = LiesWithin(at->first, field) ? files.erase(at) : std::next(at);
  }
}

// Inserts the pieces into a mapping or list and into everything below it. `files` are the files
// that are being read, from the main file to the innermost piece.
void PutInPieces(YAML::Node node, const std::string& path,
                 const std::vector<std::filesystem::path>& files, YamlDocument* document) {
  const auto below = [&path](const std::string& key) { return EntryOf(path, key); };
  if (node.IsSequence()) {
    for (size_t i = 0; i < node.size(); ++i)
      PutInPieces(node[i], fmt::format("{}[{}]", path, i), files, document);
    return;
  }
  if (!node.IsMap()) return;
  if (const YAML::Node use = std::as_const(node)["use"]; use && use.IsScalar()) {
    std::string missing;
    const std::filesystem::path given = ExpandEnvironment(use.Scalar(), &missing);
    const YAML::Mark mark = use.Mark();
    if (!missing.empty())
      Fail(files.back(), mark,
           fmt::format("{}: the environment variable {} is not set", below("use"), missing));
    const std::filesystem::path file =
        given.is_absolute() ? given : (files.back().parent_path() / given).lexically_normal();
    if (std::find(files.begin(), files.end(), file) != files.end())
      Fail(files.back(), mark, below("use") + ": " + file.string() + " would include itself");
    std::error_code no_file;  // as for a name that is too long
    if (!std::filesystem::is_regular_file(file, no_file))
      Fail(files.back(), mark, below("use") + ": there is no file " + file.string());
    YAML::Node piece = Parse(ReadWholeFile(file), file);
    std::vector<std::filesystem::path> inner = files;
    inner.push_back(file);
    PutInPieces(piece, path, inner, document);
    node.remove("use");
    for (const auto& entry : piece) {
      const std::string key = entry.first.Scalar();
      if (std::as_const(node)[key]) {
        Forget(below(key), document);
        continue;
      }
      node.force_insert(entry.first, entry.second);
      document->file_of_field.try_emplace(below(key), file);
    }
  }
  std::vector<std::string> keys;
  for (const auto& entry : node)
    if (entry.first.IsScalar()) keys.push_back(entry.first.Scalar());
  for (const std::string& key : keys) {
    if (document->file_of_field.count(below(key)) > 0) continue;  // from a piece, already complete
    PutInPieces(node[key], below(key), files, document);
  }
}

}  // namespace

SourcePosition PositionOf(const std::filesystem::path& file, const YAML::Mark& mark) {
  if (mark.is_null()) return {file.string()};
  return {file.string(), mark.line + 1, mark.column + 1};
}

const std::filesystem::path& YamlDocument::FileOf(std::string field) const {
  while (!field.empty()) {
    const auto found = file_of_field.find(field);
    if (found != file_of_field.end()) return found->second;
    const size_t cut = field.find_last_of(".[");
    field.resize(cut == std::string::npos ? 0 : cut);
  }
  return file;
}

YamlDocument ParseYaml(const std::string& text, const std::filesystem::path& file) {
  YamlDocument document{file, std::make_shared<YAML::Node>(Parse(text, file)), {}};
  PutInPieces(*document.root, "", {file.lexically_normal()}, &document);
  return document;
}

std::string ExpandEnvironment(const std::string& text, std::string* missing) {
  std::string expanded;
  size_t at = 0;
  while (true) {
    const size_t open = text.find("${", at);
    const size_t close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) return expanded + text.substr(at);
    expanded += text.substr(at, open - at);
    std::string name = text.substr(open + 2, close - open - 2);
    std::string fallback;
    const size_t dash = name.find(":-");
    const bool has_fallback = dash != std::string::npos;
    if (has_fallback) {
      fallback = name.substr(dash + 2);
      name.resize(dash);
    }
    const char* value = std::getenv(name.c_str());
    if (value != nullptr && *value != '\0') {
      expanded += value;
    } else if (has_fallback) {
      expanded += fallback;
    } else {
      *missing = name;
    }
    at = close + 1;
  }
}

}  // namespace lacuna

#include "experiment/kept_recording.h"

#include <algorithm>
#include <vector>

#include "core/atomic_file.h"
#include "core/hash.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kMark[] = "scene.key";

// The content of scene.key for the current files of a folder.
std::string MarkOf(const fs::path& folder, const std::string& key) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename() != kMark) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string content;
  for (const fs::path& file : files)
    content += fs::relative(file, folder).string() + " " + HashFile(file) + "\n";
  return key + " " + HashBytes(content) + "\n";
}

}  // namespace

bool IsKeptRecording(const fs::path& folder, const std::string& key) {
  const fs::path mark = folder / kMark;
  return fs::exists(mark) && ReadWholeFile(mark) == MarkOf(folder, key);
}

void MarkRecording(const fs::path& folder, const std::string& key) {
  WriteFileAtomically(folder / kMark, MarkOf(folder, key));
}

void KeepRecording(const Scene& scene, const SceneMotion& motion, const fs::path& folder,
                   const std::string& key) {
  MakeFolder(folder);
  fs::remove(folder / kMark);
  WriteSceneRecording(scene, motion, folder);
  MarkRecording(folder, key);
}

}  // namespace lacuna

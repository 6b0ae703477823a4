// A scene's recording that is made once and found again. Beside it lies scene.key: what it was made
// from, and a hash of its files. It is written last, so that half a recording, or one that was
// changed since, is none.
#ifndef LACUNA_EXPERIMENT_KEPT_RECORDING_H_
#define LACUNA_EXPERIMENT_KEPT_RECORDING_H_

#include <filesystem>
#include <string>

#include "experiment/scene.h"

namespace lacuna {

// Whether `folder` holds the recording that `key` names, as it was written.
bool IsKeptRecording(const std::filesystem::path& folder, const std::string& key);
// Says that it does. Throws InputError when that cannot be written, as KeepRecording does.
void MarkRecording(const std::filesystem::path& folder, const std::string& key);
void KeepRecording(const Scene& scene, const SceneMotion& motion,
                   const std::filesystem::path& folder, const std::string& key);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_KEPT_RECORDING_H_

// Keeps the recording of a synthetic scene, so that it is made only once. The file scene.key beside
// it holds the key of the scene and a hash of the recording's files. It is written last, so that a
// recording that is incomplete or was changed later is recognised.
#ifndef LACUNA_EXPERIMENT_KEPT_RECORDING_H_
#define LACUNA_EXPERIMENT_KEPT_RECORDING_H_

#include <filesystem>
#include <string>

#include "experiment/scene.h"

namespace lacuna {

// Whether `folder` holds the unchanged recording of the scene with this key.
bool IsKeptRecording(const std::filesystem::path& folder, const std::string& key);
// Writes scene.key for a recording that is complete. Throws InputError when it cannot be written.
void MarkRecording(const std::filesystem::path& folder, const std::string& key);
// Writes the recording and then scene.key. Throws InputError when they cannot be written.
void KeepRecording(const Scene& scene, const SceneMotion& motion,
                   const std::filesystem::path& folder, const std::string& key);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_KEPT_RECORDING_H_

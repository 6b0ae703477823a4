// Stage 4 of the paper: the undeformed body, from the first surface or from a given shape.
#ifndef LACUNA_EXPERIMENT_REFERENCE_BODY_H_
#define LACUNA_EXPERIMENT_REFERENCE_BODY_H_

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/model_reader.h"
#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"
#include "record/run_record.h"
#include "scan/recording.h"

namespace lacuna {

struct ReferenceBody {
  TetMesh mesh;  // with the order of elements that was asked for; world frame, m
  MeshRecord quality;
  std::vector<std::string> notes;
};

// What the undeformed body is made from. The members must outlive the request.
struct ReferenceRequest {
  const std::string& name;  // name of the study, for messages
  const Recording& recording;
  const MeshSettings& mesh;
  int sheet_layers = 1;
  int first_frame = 0;
  const TriMesh* first_surface = nullptr;  // surface of that frame; null where there is none
};

// Throws InputError with the reason when the shape cannot be meshed, and OutOfMemory
// (core/memory_limit.h) when its mesh does not fit into memory.
ReferenceBody MakeReferenceBody(const ReferenceRequest& request);

// The files of a run directory: body.msh and notes.txt.
void WriteReferenceBody(const ReferenceBody& body, const std::filesystem::path& folder);
ReferenceBody ReadReferenceBody(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_REFERENCE_BODY_H_

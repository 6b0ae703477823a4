#include "record/prior_conflict.h"

#include "record/tagged_json.h"

namespace lacuna {

template <typename Visitor>
void VisitFields(Visitor& visit, NuisanceParameterConflict& conflict) {
  visit.Kind("nuisance_parameter");
  visit("parameter", conflict.parameter);
  visit("deviations", conflict.deviations);
}

template <typename Visitor>
void VisitFields(Visitor& visit, ModelParameterConflict& conflict) {
  visit.Kind("model_parameter");
  visit("parameter", conflict.parameter);
  visit("unit", conflict.unit);
  visit("deviations", conflict.deviations);
  visit("mean", conflict.mean);
  visit("is_default", conflict.is_default);
}

template <typename Visitor>
void VisitFields(Visitor& visit, MarkerConflict& conflict) {
  visit.Kind("marker");
  visit("recording", conflict.recording);
  visit("marker", conflict.marker);
  visit("offset_m", conflict.offset);
  visit("deviation_m", conflict.deviation);
}

template <typename Visitor>
void VisitFields(Visitor& visit, MarkerConflictCount& conflict) {
  visit.Kind("marker_count");
  visit("recording", conflict.recording);
  visit("conflicting", conflict.conflicting);
  visit("markers", conflict.markers);
}

template <typename Visitor>
void VisitFields(Visitor& visit, ReferenceShapeConflict& conflict) {
  visit.Kind("reference_shape");
  visit("recording", conflict.recording);
  visit("frame", conflict.frame);
  visit("rms_m", conflict.rms);
  visit("deviation_m", conflict.deviation);
}

template <typename Visitor>
void VisitFields(Visitor& visit, PatchConflict& conflict) {
  visit.Kind("patches");
  visit("recording", conflict.recording);
  visit("conflicting", conflict.conflicting);
  visit("patches", conflict.patches);
  visit("largest_m", conflict.largest);
  visit("deviation_m", conflict.deviation);
}

template <typename Visitor>
void VisitFields(Visitor& visit, UnmatchedScans& conflict) {
  visit.Kind("unmatched_scans");
  visit("recording", conflict.recording);
  visit("unmatched", conflict.unmatched);
  visit("frames", conflict.frames);
  visit("first_time_s", conflict.first_time);
  visit("least_share", conflict.least_share);
}

nlohmann::json PriorConflictToJson(const PriorConflict& conflict) { return TaggedToJson(conflict); }

PriorConflict PriorConflictFromJson(const nlohmann::json& value) {
  return TaggedFromJson<PriorConflict>(value);
}

}  // namespace lacuna

// Which physical effect a fitted model lacks.
//
// 1. Every effect of the catalogue is tried on the fitted trajectory to first order, all in one
//    tangent-linear run, and scored by the evidence for it (analysis/effect_score.h), beside the
//    nuisances that look like physics: a mesh that is too coarse.
// 2. The best are added to the model one at a time and fitted with it; what counts is how much the
//    error falls on frames and recordings that were held out.
// 3. The verdict says what the held-out error allows to say, no more.
// docs/diagnosis.md explains the method and its limits.
#ifndef LACUNA_STUDY_DIAGNOSIS_H_
#define LACUNA_STUDY_DIAGNOSIS_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/progress.h"
#include "study/calibration_problem.h"
#include "study/effect_ranking.h"

namespace lacuna {

struct DiagnosisOptions {
  int refits = 3;  // of the best scored effects; more: slower, a wrong ranking is forgiven
};

// A scored effect, and what came of fitting it.
struct RankedEffect {
  ScoredEffect scored;
  // After the refit, where there was one.
  bool refitted = false;
  std::string refit_message;                // why it is not usable; empty: it is
  double in_fit_rms = 0, held_out_rms = 0;  // m
  double in_noise = 0;                      // held out, in σ
  Calibration calibration;
};

struct Diagnosis {
  enum class Verdict { kAdequate, kMissing, kAmbiguous, kNuisance, kNotInLibrary, kNoPower };
  Verdict verdict = Verdict::kNoPower;
  std::vector<std::string> effects;  // named by the verdict
  std::string explanation;           // in words
  std::string experiment;            // that would settle it; empty: none is needed
  double noise = 0;                  // m
  double in_fit_rms = 0, held_out_rms = 0, in_noise = 0;  // of the present model
  bool has_held_out = false;  // false: the errors are those of fitted frames, and weigh less
  std::vector<RankedEffect> ranking;  // by evidence
  double mesh_share = 0;              // of the residual that a finer mesh and step would explain
  int scored = 0;                     // effects and variants
};

std::string VerdictName(Diagnosis::Verdict verdict);

// Of the study fitted to `values` (CalibrationProblem::parameters). Throws Interrupted.
Diagnosis Diagnose(const CalibrationProblem& problem, const TetMesh& mesh,
                   const Eigen::VectorXd& values, const DiagnosisOptions& options,
                   Progress* progress);

// The study with the effect in its model, all of whose parameters are fitted.
PredictionStudy WithEffect(const PredictionStudy& study, const ScoredEffect& effect);

// diagnosis.json
void SaveDiagnosis(const Diagnosis& diagnosis, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_STUDY_DIAGNOSIS_H_

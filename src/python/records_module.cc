// The extension lacuna._records: finished runs of `lacuna fit` as objects of Python and NumPy.
//
// Runs are read by the code that the program reads them with, which checks hashes and versions of
// formats. Files are read without Python's lock, so that other threads go on meanwhile.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "core/error.h"
#include "record/csv_table.h"
#include "record/decision_record.h"
#include "record/library_versions.h"
#include "record/recorded_residuals.h"
#include "record/verdict.h"
#include "report/reported_run.h"

namespace lacuna {
namespace {

namespace py = pybind11;
using Array = py::array_t<double>;

// The points of one recording, as the fit wrote them.
struct Motion {
  RecordedResiduals residuals;
  bool is_scan = false;
};

// (frames, points, 3), from 3 points × frames: both have the same order in memory.
Array AsPoints(const Eigen::MatrixXd& matrix) {
  return Array({matrix.cols(), matrix.rows() / 3, Eigen::Index{3}}, matrix.data());
}

Array AsVector(const Eigen::VectorXd& values) { return Array(values.size(), values.data()); }

// One number of each element of a list.
template <typename Item, typename Get>
Array Column(const std::vector<Item>& items, const Get& get) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(items.size()));
  std::transform(items.begin(), items.end(), values.begin(), get);
  return AsVector(values);
}

Motion ReadMotion(const ReportedModel& model, size_t recording) {
  if (recording >= model.calibration.recordings.size())
    throw py::index_error("the run has no recording of this number");
  const py::gil_scoped_release unlocked;
  const std::filesystem::path file = model.folder / "calibration/misfit.csv";
  return {ReadResiduals(ReadCsv(file), static_cast<int>(recording), file),
          model.calibration.recordings[recording].scan.has_value()};
}

// The names of the points of a recording; empty for scans that were not compared.
std::vector<std::string> PointNames(const ReportedModel& model, size_t recording) {
  if (model.comparison) return model.comparison->recordings.at(recording).point_names;
  return model.calibration.recordings.at(recording).marker_names;
}

void DefineParameters(py::module_* module) {
  py::class_<FittedParameter>(*module, "Parameter", "A fitted parameter, in SI units")
      .def_readonly("name", &FittedParameter::name)
      .def_readonly("unit", &FittedParameter::unit)
      .def_property_readonly("value", [](const FittedParameter& p) { return p.estimate.value; })
      .def_readonly("at_limit", &FittedParameter::at_limit,
                    "the value with infinitely fine elements and time steps, whose interval `low` "
                    "to `high` is; None: it was not computed, and the interval is that of `value`")
      .def_property_readonly(
          "low", [](const FittedParameter& p) { return p.estimate.low; },
          "lower end of the 95 % interval")
      .def_property_readonly(
          "high", [](const FittedParameter& p) { return p.estimate.high; },
          "upper end of the 95 % interval")
      .def_property_readonly(
          "verdict",
          [](const FittedParameter& p) { return DeterminationName(p.estimate.determination); },
          "whether the recordings determine it: \"pinned down\", \"traded off\", ...")
      .def("__repr__", [](const FittedParameter& p) {
        const std::string limit = p.at_limit ? fmt::format("at_limit {:.4g}: ", *p.at_limit) : "";
        return fmt::format("<{} = {:.4g} ({}{:.4g} to {:.4g}) {}>", p.name, p.estimate.value, limit,
                           p.estimate.low, p.estimate.high, p.unit);
      });
}

void DefineRecordings(py::module_* module) {
  py::class_<MisfitMeasure>(*module, "Errors", "Errors over some frames; lengths in m")
      .def_readonly("frames", &MisfitMeasure::frames)
      .def_readonly("points", &MisfitMeasure::points)
      .def_readonly("rms", &MisfitMeasure::rms)
      .def_readonly("largest", &MisfitMeasure::largest)
      .def_readonly("rms_over_sigma", &MisfitMeasure::rms_over_sigma)
      .def_readonly("rms_at_measured_places", &MisfitMeasure::rms_at_measured_places);
  py::class_<FittedRecording>(*module, "Recording", "What a fit says of one recording")
      .def_readonly("name", &FittedRecording::name)
      .def_readonly("fitted", &FittedRecording::fitted)
      .def_readonly("noise", &FittedRecording::noise)
      .def_readonly("in_fit", &FittedRecording::in_fit)
      .def_readonly("held_out", &FittedRecording::held_out);
  py::class_<Motion>(*module, "Motion", "Measured and predicted places of a recording's points, m")
      .def_property_readonly("times", [](const Motion& m) { return AsVector(m.residuals.times); })
      .def_property_readonly(
          "fitted",
          [](const Motion& m) {
            py::array_t<bool> flags(static_cast<py::ssize_t>(m.residuals.fitted.size()));
            std::copy(m.residuals.fitted.begin(), m.residuals.fitted.end(), flags.mutable_data());
            return flags;
          },
          "for each frame: whether it was fitted, or held out")
      .def_property_readonly(
          "measured", [](const Motion& m) { return AsPoints(m.residuals.measured); },
          "(frames, points, 3); NaN where a point was not seen")
      .def_property_readonly(
          "predicted",
          [](const Motion& m) { return AsPoints(m.residuals.measured + m.residuals.difference); },
          "(frames, points, 3); of a scan, the measured places moved along the surface's normal")
      .def_property_readonly(
          "sigma",
          [](const Motion& m) {
            const Eigen::MatrixXd& sigma = m.residuals.sigma;
            return Array({sigma.cols(), sigma.rows()}, sigma.data());
          },
          "(frames, points): standard deviation of the noise of each coordinate of a point, of a "
          "scan along the normal; NaN where it was not seen; empty in runs of earlier versions")
      .def_readonly("is_scan", &Motion::is_scan);
}

void DefineDiagnosis(py::module_* module) {
  py::class_<HypothesisProbability>(*module, "Hypothesis", "What may be missing")
      .def_property_readonly(
          "kind", [](const HypothesisProbability& h) { return HypothesisKindName(h.kind); })
      .def_readonly("names", &HypothesisProbability::names)
      .def_readonly("probability", &HypothesisProbability::probability)
      .def_readonly("evidence", &HypothesisProbability::evidence,
                    "log Bayes factor against the model as it is, less the logarithm of the number "
                    "of effects (or nuisances) that were tried and, of effects, less what the "
                    "error of the model could give to one; for two effects, or an effect with a "
                    "nuisance, see docs/diagnosis.md, section 4")
      .def("__repr__", [](const HypothesisProbability& h) {
        return fmt::format("<{} {}: {:.3f}>", HypothesisKindName(h.kind), fmt::join(h.names, " + "),
                           h.probability);
      });
  py::class_<DiagnosisRecord>(*module, "Diagnosis", "What a diagnosis found")
      .def_property_readonly("verdict",
                             [](const DiagnosisRecord& d) { return VerdictName(d.verdict); })
      .def_readonly("effects", &DiagnosisRecord::effects,
                    "names of the missing effects or of the nuisances, the best first")
      .def_property_readonly(
          "hypotheses", [](const DiagnosisRecord& d) { return d.decision.probabilities; },
          "all that were tried, the most probable first")
      .def_property_readonly("probabilities", [](const DiagnosisRecord& d) {
        return Column(d.decision.probabilities,
                      [](const HypothesisProbability& h) { return h.probability; });
      });
}

void DefineModel(py::module_* module) {
  const auto estimate = [](const ReportedModel& model, double ParameterEstimate::*number) {
    return Column(model.calibration.parameters,
                  [number](const FittedParameter& p) { return p.estimate.*number; });
  };
  py::class_<ReportedModel>(*module, "Model", "A fitted model of a run")
      .def_readonly("folder", &ReportedModel::folder)
      .def_readonly("name", &ReportedModel::name)
      .def_readonly("added", &ReportedModel::added,
                    "the effect that the model before it lacks; empty: none")
      .def_property_readonly("usable", [](const ReportedModel& m) { return m.calibration.usable; })
      .def_property_readonly("message",
                             [](const ReportedModel& m) { return m.calibration.message; })
      .def_property_readonly("parameters",
                             [](const ReportedModel& m) { return m.calibration.parameters; })
      .def_property_readonly(
          "values",
          [estimate](const ReportedModel& m) { return estimate(m, &ParameterEstimate::value); },
          "the values of the parameters with the elements and time steps of the fit, SI")
      .def_property_readonly(
          "at_limit",
          [](const ReportedModel& m) {
            return Column(m.calibration.parameters, [](const FittedParameter& p) {
              return p.at_limit.value_or(kNotMeasured);
            });
          },
          "the values with infinitely fine elements and time steps, SI; NaN: not computed")
      .def_property_readonly(
          "intervals",
          [](const ReportedModel& m) {
            const auto& parameters = m.calibration.parameters;
            Array ends({static_cast<py::ssize_t>(parameters.size()), py::ssize_t{2}});
            auto entry = ends.mutable_unchecked<2>();
            for (py::ssize_t k = 0; k < entry.shape(0); ++k) {
              entry(k, 0) = parameters[static_cast<size_t>(k)].estimate.low;
              entry(k, 1) = parameters[static_cast<size_t>(k)].estimate.high;
            }
            return ends;
          },
          "(parameters, 2): the 95 % intervals, SI, of `at_limit`, or of `values` where it is NaN")
      .def_property_readonly("recordings",
                             [](const ReportedModel& m) { return m.calibration.recordings; })
      .def_readonly("diagnosis", &ReportedModel::diagnosis, "None: there is none of this fit")
      .def("motion", &ReadMotion, py::arg("recording") = 0,
           "measured and predicted places of the points of a recording")
      .def("point_names", &PointNames, py::arg("recording") = 0,
           "the names of its markers, and of its patches once `compare` has run")
      .def("__repr__", [](const ReportedModel& m) { return fmt::format("<Model {}>", m.name); });
}

}  // namespace

PYBIND11_MODULE(_records, module) {
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Input that Lacuna cannot use; the message names the file and the fault";
  module.attr("version") = ProgramVersion();
  DefineParameters(&module);
  DefineRecordings(&module);
  DefineDiagnosis(&module);
  DefineModel(&module);
  module.def(
      "open_models",
      [](const std::filesystem::path& folder) {
        const py::gil_scoped_release unlocked;
        return OpenReportedRun(folder).models;
      },
      py::arg("folder"), "the models of a finished run, the first one first");
}

}  // namespace lacuna

#include "exchange/calculix.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/atomic_file.h"
#include "core/run_program.h"
#include "core/text_file.h"
#include "exchange/inp_writer.h"

namespace lacuna {
namespace {

// The lines of the log from the first error on, at most six.
std::string ErrorsIn(const std::string& log) {
  const size_t error = log.find("*ERROR");
  if (error == std::string::npos) return "its log is model.log";
  std::istringstream lines(log.substr(error));
  std::string text;
  int count = 0;
  for (std::string line; count < 6 && std::getline(lines, line); ++count) {
    const size_t begin = line.find_first_not_of(' ');
    if (begin != std::string::npos) text += (text.empty() ? "" : " ") + line.substr(begin);
  }
  return text;
}

// Reads the tables "displacements … for set … and time …" of model.dat.
Eigen::MatrixXd ReadDisplacements(const std::string& text, Eigen::Index nodes,
                                  const std::vector<double>& frames, size_t* read) {
  Eigen::MatrixXd displacement =
      Eigen::MatrixXd::Zero(3 * nodes, static_cast<Eigen::Index>(frames.size()) + 1);
  std::istringstream lines(text);
  Eigen::Index column = -1;
  *read = 0;
  for (std::string line; std::getline(lines, line);) {
    const size_t time = line.find("and time");
    if (time != std::string::npos) {
      column = -1;
      if (line.find("displacements") == std::string::npos) continue;
      const double at = std::strtod(line.c_str() + time + 8, nullptr) - kInpRampTime;
      // Times have seven digits.
      const double tolerance = 1e-6 * (kInpRampTime + std::max(at, 0.0));
      for (size_t k = 0; k <= frames.size(); ++k)
        if (std::abs(at - (k == 0 ? 0 : frames[k - 1])) < tolerance)
          column = static_cast<Eigen::Index>(k);
      *read += column >= 0;
      continue;
    }
    std::istringstream values(line);
    Eigen::Index node = 0;
    double x = 0, y = 0, z = 0;
    if (column < 0 || !(values >> node >> x >> y >> z) || node < 1 || node > nodes) continue;
    displacement.block<3, 1>(3 * (node - 1), column) << x, y, z;
  }
  return displacement;
}

}  // namespace

bool HasCalculix() { return FindProgram("ccx").has_value(); }

CalculixResult RunCalculix(const std::filesystem::path& inp, const std::filesystem::path& folder,
                           Eigen::Index nodes, const std::vector<double>& frames) {
  using Status = CalculixResult::Status;
  const auto program = FindProgram("ccx");
  if (!program) return {Status::kAbsent, "there is no ccx on the PATH", {}};
  MakeFolder(folder);
  WriteFileAtomically(folder / "model.inp", ReadWholeFile(inp));
  std::error_code ignored;
  std::filesystem::remove(folder / "model.dat", ignored);
  const std::filesystem::path log_file = std::filesystem::absolute(folder) / "model.log";
  const int status = RunProgram({.program = *program,
                                 .arguments = {"-i", "model"},
                                 .folder = folder,
                                 .output = log_file,
                                 .with_errors = true,
                                 .environment = {"OMP_NUM_THREADS=1"}});
  const std::string log = ReadWholeFile(log_file);
  if (status != 0 || log.find("Job finished") == std::string::npos)
    return {Status::kFailed, "ccx stopped: " + ErrorsIn(log), {}};
  size_t read = 0;
  CalculixResult result{
      Status::kDone, "",
      ReadDisplacements(ReadWholeFile(folder / "model.dat"), nodes, frames, &read)};
  if (read == frames.size() + 1) return result;
  return {Status::kFailed, fmt::format("ccx wrote {} of {} states", read, frames.size() + 1), {}};
}

DisplacementDifference CompareDisplacements(const Eigen::MatrixXd& expected,
                                            const Eigen::MatrixXd& found) {
  CHECK(expected.rows() == found.rows() && expected.cols() == found.cols());
  const auto lengths = [](const Eigen::MatrixXd& vectors) -> Eigen::VectorXd {
    return vectors.reshaped(3, vectors.size() / 3).colwise().norm();
  };
  DisplacementDifference difference;
  if (expected.size() == 0) return difference;
  difference.largest_displacement = lengths(expected).maxCoeff();
  const Eigen::VectorXd errors = lengths(found - expected);
  difference.largest_difference = errors.maxCoeff();
  const double scale = std::max(difference.largest_displacement, 1e-300);
  difference.largest = difference.largest_difference / scale;
  difference.rms = std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size())) / scale;
  return difference;
}

}  // namespace lacuna

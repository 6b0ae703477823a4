// A quantity that an effect derives from the rest shape of its body, computed once and kept.
#ifndef LACUNA_EFFECTS_REST_QUANTITY_H_
#define LACUNA_EFFECTS_REST_QUANTITY_H_

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "fem/body.h"

namespace lacuna {

// Keeps one value for each mesh in use; may be called from several threads. Copies share the
// values, so that an effect with other parameter values need not derive them again. `T` may depend
// on the mesh at rest and on the settings given to SetSettings, but not on the density, which
// another body of the same mesh may have different. Not for elasticity laws: free strains call them
// with a body of the same mesh that has other weights and shape gradients.
template <typename T>
class RestQuantity {
 public:
  // Sets the numbers on which the value depends besides the mesh; none by default. If they differ
  // from the present ones, the value is derived anew; copies made before keep theirs. Called by
  // SetParameters of an effect, before other threads know the effect.
  void SetSettings(const Eigen::VectorXd& settings) {
    if (settings.size() == settings_.size() && settings == settings_) return;
    settings_ = settings;
    kept_ = std::make_shared<Kept>();
  }

  // Returns the kept value, or calls make(body, settings) if there is none for the mesh of this
  // body. What `make` returns should depend on its two arguments only.
  template <typename Make>
  std::shared_ptr<const T> Of(const Body& body, const Make& make) const {
    const std::scoped_lock lock(kept_->mutex);
    // Bodies of one mesh share its schedule, which therefore identifies the mesh.
    for (const auto& [mesh, value] : kept_->values)
      if (mesh.lock() == body.schedule) return value;
    std::erase_if(kept_->values, [](const auto& entry) { return entry.first.expired(); });
    auto made = std::make_shared<const T>(make(body, settings_));
    return kept_->values.emplace_back(body.schedule, std::move(made)).second;
  }

 private:
  struct Kept {
    std::mutex mutex;
    std::vector<std::pair<std::weak_ptr<const ElementSchedule>, std::shared_ptr<const T>>> values;
  };
  Eigen::VectorXd settings_;
  std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_REST_QUANTITY_H_

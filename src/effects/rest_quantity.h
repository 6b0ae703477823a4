// What an effect derives from the rest shape of its body, computed once and kept.
#ifndef LACUNA_EFFECTS_REST_QUANTITY_H_
#define LACUNA_EFFECTS_REST_QUANTITY_H_

#include <memory>
#include <mutex>

#include "fem/body.h"

namespace lacuna {

// The value for the body that was asked about last; safe to ask from several threads. `T` may
// depend on the mesh at rest and on the effect's settings (call Forget when they change), not on
// the density, which another copy of the body may have different.
template <typename T>
class RestQuantity {
 public:
  // make(body), at the first call for this body.
  template <typename Make>
  std::shared_ptr<const T> Of(const Body& body, const Make& make) const {
    const std::scoped_lock lock(mutex_);
    // Bodies of one mesh share its schedule. To hold it keeps its address from being used again.
    if (mesh_ != body.schedule) {
      value_ = std::make_shared<const T>(make(body));
      mesh_ = body.schedule;
    }
    return value_;
  }

  void Forget() {
    const std::scoped_lock lock(mutex_);
    mesh_ = nullptr;
    value_ = nullptr;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const ElementSchedule> mesh_;
  mutable std::shared_ptr<const T> value_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_REST_QUANTITY_H_

// A quantity that an effect derives from the rest shape of its body, computed once and kept.
#ifndef LACUNA_EFFECTS_REST_QUANTITY_H_
#define LACUNA_EFFECTS_REST_QUANTITY_H_

#include <memory>
#include <mutex>

#include "fem/body.h"

namespace lacuna {

// Keeps the value for the body that was asked about last. Several threads may call Of at once; the
// value stays valid as long as the caller holds the pointer. The value may depend on the mesh at
// rest and on the settings of the effect (call Forget when they change), but not on the density, in
// which another body of the same mesh may differ.
template <typename T>
class RestQuantity {
 public:
  // Returns the kept value, or calls make(body) if there is none for the mesh of this body.
  template <typename Make>
  std::shared_ptr<const T> Of(const Body& body, const Make& make) const {
    const std::scoped_lock lock(mutex_);
    // Bodies of one mesh share its schedule. Holding it prevents its address from being reused.
    if (mesh_ != body.schedule) {
      value_ = std::make_shared<const T>(make(body));
      mesh_ = body.schedule;
    }
    return value_;
  }

  // Discards the kept value.
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

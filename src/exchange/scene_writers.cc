#include "exchange/scene_writers.h"

namespace lacuna {
namespace {

using How = Counterpart::Kind;

}  // namespace

void AddLostMidpoints(const PortableModel& model, Counterparts* parts) {
  if (model.mesh.Order() == 2)
    parts->push_back(
        {"quadratic elements", How::kNone,
         "linear ones of the corner nodes are written, which are too stiff in bending"});
}

void AddLostStart(const PortableModel& model, Counterparts* parts) {
  if (model.held_force.size() > 0)
    parts->push_back({"hold", How::kNone, "the scene begins when the force is gone"});
  parts->push_back({"equilibrium at the start", How::kNone,
                    "the scene begins with the rest shape, to which gravity and loads are applied "
                    "at once"});
  if (model.is_static)
    parts->push_back({"quasi-static motion", How::kNone, "the scene has inertia"});
}

}  // namespace lacuna

#include <geom/scene.h>

#include "scene/bodies.h"

#include <geom/kernel/refuse.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace geom {

Scene::Scene(const SceneOptions& options) : bodies_(std::make_unique<Bodies>(options)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&& other) noexcept = default;
Scene& Scene::operator=(Scene&& other) noexcept = default;

BodyId Scene::add(const SceneShape& shape, const Pose& X_WB, Filter filter) {
  return bodies_->add(shape.any(), X_WB, filter);
}

void Scene::remove(BodyId body) {
  bodies_->remove(body);
}

void Scene::move(std::span<const BodyId> bodies, std::span<const Pose> X_WB) {
  if (bodies.size() != X_WB.size()) {
    kernel::refuse("Scene::move: " + std::to_string(bodies.size()) + " bodies and " + std::to_string(X_WB.size()) +
                   " poses; accepted: as many of both");
  }
  // What may throw comes before the first one moves.
  std::vector<std::pair<std::int32_t, scene::Placement>> moves;
  moves.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::int32_t item = bodies_->item(bodies[k]);
    moves.emplace_back(item, bodies_->placement(bodies_->at(item).shape, X_WB[k], "Scene::move"));
  }
  for (const auto& [item, to] : moves) bodies_->move(item, to);
}

void Scene::move(BodyId body, const Pose& X_WB) {
  move(std::span(&body, 1), std::span(&X_WB, 1));
}

struct Scene::Places {
  std::vector<std::pair<BodyId, scene::Placement>> of_bodies;
};

std::shared_ptr<const Scene::Places> Scene::places(std::span<const BodyId> bodies) const {
  auto places = std::make_shared<Places>();
  places->of_bodies.reserve(bodies.size());
  for (const BodyId id : bodies) {
    const std::int32_t item = bodies_->item(id);
    const scene::Body& body = bodies_->at(item);
    places->of_bodies.push_back({id, {body.X_WB, body.cell, body.shift, bodies_->broad.tight(item)}});
  }
  return places;
}

void Scene::put_back(const Places& places) noexcept {
  for (const auto& [id, place] : places.of_bodies) {
    if (has(id)) bodies_->move(bodies_->item_of[static_cast<std::size_t>(id)], place);
  }
}

void Scene::set_filter(BodyId body, Filter filter) {
  bodies_->at(bodies_->item(body)).filter = filter;
}

std::size_t Scene::size() const {
  return bodies_->count;
}

bool Scene::has(BodyId body) const {
  const auto k = static_cast<std::size_t>(body);
  return k < bodies_->item_of.size() && bodies_->item_of[k] >= 0;
}

Pose Scene::pose(BodyId body) const {
  return bodies_->at(bodies_->item(body)).X_WB;
}

std::variant<Shape, AnyConvex> Scene::shape(BodyId body) const {
  return bodies_->at(bodies_->item(body)).shape;
}

Filter Scene::filter(BodyId body) const {
  return bodies_->at(bodies_->item(body)).filter;
}

std::vector<BodyId> Scene::bodies() const {
  std::vector<BodyId> handles;
  handles.reserve(size());
  for (std::size_t k = 0; k < bodies_->item_of.size(); ++k) {
    if (bodies_->item_of[k] >= 0) handles.push_back(static_cast<BodyId>(k));
  }
  return handles;
}

const SceneOptions& Scene::options() const {
  return bodies_->options;
}

}  // namespace geom

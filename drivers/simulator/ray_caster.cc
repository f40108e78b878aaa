#include "drivers/simulator/ray_caster.h"

#include "estimation/base/check.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kLanes = RayPacket::kLanes;

// One thread builds, so that the same scene gives the same hierarchy.
constexpr const char* kDeviceOptions = "threads=1,set_affinity=0";

bool CountMemory(void* counter, ssize_t num_bytes, bool /*is_post*/) {
  static_cast<std::atomic<std::ptrdiff_t>*>(counter)->fetch_add(num_bytes);
  return true;
}

class SceneHandle {
 public:
  SceneHandle() = default;
  explicit SceneHandle(RTCScene scene) : scene_(scene) {}
  SceneHandle(SceneHandle&& other) noexcept
      : scene_(std::exchange(other.scene_, nullptr)) {}
  SceneHandle& operator=(SceneHandle&& other) noexcept {
    std::swap(scene_, other.scene_);
    return *this;
  }
  SceneHandle(const SceneHandle&) = delete;
  SceneHandle& operator=(const SceneHandle&) = delete;
  ~SceneHandle() {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
  }
  [[nodiscard]] RTCScene get() const { return scene_; }

 private:
  RTCScene scene_ = nullptr;
};

void ThrowOnError(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree: error " + std::to_string(error));
  }
}

// Triangles that are left out keep their number as a point, which no ray
// meets.
void FillIndices(const Scene& scene,
                 const SceneMesh& mesh,
                 RayCaster::Content content,
                 std::uint32_t* indices) {
  for (const SceneTriangle& triangle : mesh.triangles) {
    const bool is_left_out =
        content == RayCaster::Content::kOccluders &&
        scene.surfaces[triangle.surface].kind == SurfaceKind::kLamp;
    for (std::size_t i = 0; i < 3; ++i) {
      *indices++ = triangle.vertices[is_left_out ? 0 : i];
    }
  }
}

SceneHandle BuildMesh(RTCDevice device,
                      const Scene& scene,
                      const SceneMesh& mesh,
                      RayCaster::Content content) {
  SceneHandle handle(rtcNewScene(device));
  rtcSetSceneFlags(handle.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(handle.get(), RTC_BUILD_QUALITY_HIGH);
  if (!mesh.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                    RTC_BUFFER_TYPE_VERTEX,
                                                    0,
                                                    RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float),
                                                    mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry,
                                RTC_BUFFER_TYPE_INDEX,
                                0,
                                RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t),
                                mesh.triangles.size()));
    if (positions != nullptr && indices != nullptr) {
      for (const Eigen::Vector3f& p : mesh.positions) {
        positions = std::copy_n(p.data(), 3, positions);
      }
      FillIndices(scene, mesh, content, indices);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(handle.get(), geometry);
    }
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(handle.get());
  ThrowOnError(device);
  return handle;
}

void CopyRays(const RayPacket& packet, RTCRay8* rays, int* valid) {
  std::copy_n(packet.origin[0], kLanes, rays->org_x);
  std::copy_n(packet.origin[1], kLanes, rays->org_y);
  std::copy_n(packet.origin[2], kLanes, rays->org_z);
  std::copy_n(packet.nearest, kLanes, rays->tnear);
  std::copy_n(packet.direction[0], kLanes, rays->dir_x);
  std::copy_n(packet.direction[1], kLanes, rays->dir_y);
  std::copy_n(packet.direction[2], kLanes, rays->dir_z);
  std::copy_n(packet.farthest, kLanes, rays->tfar);
  for (int i = 0; i < kLanes; ++i) {
    valid[i] = (packet.active >> i & 1u) != 0 ? -1 : 0;
    rays->time[i] = 0.0f;
    rays->mask[i] = ~0u;
    rays->id[i] = 0;
    rays->flags[i] = 0;
  }
}

RTCIntersectContext ContextOf(const RayPacket& packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = packet.is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                     : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

// A ball that holds a mesh.
struct Ball {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

Ball BallAbout(const SceneMesh& mesh) {
  if (mesh.positions.empty()) return {};
  Eigen::Vector3f low = mesh.positions[0];
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d middle =
      0.5 * (low.cast<double>() + high.cast<double>());
  double radius = 0.0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    radius = std::max(radius, (p.cast<double>() - middle).norm());
  }
  return {middle, radius};
}

// Lanes whose lines come near a ball. Most packets come near no mover, which is
// told sooner here than by Embree's hierarchy of instances.
std::uint32_t LanesNear(const RayPacket& packet, const Ball& ball) {
  // More than float roundings take away.
  const auto radius = static_cast<float>(1.001 * ball.radius + 1e-3);
  float outside[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const float x = static_cast<float>(ball.middle.x()) - packet.origin[0][i];
    const float y = static_cast<float>(ball.middle.y()) - packet.origin[1][i];
    const float z = static_cast<float>(ball.middle.z()) - packet.origin[2][i];
    const float along = x * packet.direction[0][i] +
                        y * packet.direction[1][i] + z * packet.direction[2][i];
    const float square = packet.direction[0][i] * packet.direction[0][i] +
                         packet.direction[1][i] * packet.direction[1][i] +
                         packet.direction[2][i] * packet.direction[2][i];
    // Square of the distance from the line, times that of the direction.
    outside[i] =
        (x * x + y * y + z * z - radius * radius) * square - along * along;
  }
  std::uint32_t lanes = 0;
  for (int i = 0; i < kLanes; ++i) {
    // NaN counts as near.
    lanes |= outside[i] > 0.0f ? 0u : 1u << i;
  }
  return lanes;
}

}  // namespace

struct RayCaster::State {
  // Before the device, which counts until its end.
  std::atomic<std::ptrdiff_t> num_bytes = 0;
  RTCDevice device = nullptr;
  SceneHandle mesh;
  std::vector<SceneHandle> movers;
  std::vector<Ball> balls;  // About the movers, in their frames.

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    mesh = SceneHandle();
    movers.clear();
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

struct RayCaster::Placement::State {
  SceneHandle scene;
  std::vector<Ball> balls;  // In W.
};

RayCaster::RayCaster(const Scene& scene, Content content)
    : state_(std::make_unique<State>()) {
  CheckScene(scene);
  state_->device = rtcNewDevice(kDeviceOptions);
  if (state_->device == nullptr) ThrowOnError(nullptr);
  rtcSetDeviceMemoryMonitorFunction(
      state_->device, CountMemory, &state_->num_bytes);
  state_->mesh = BuildMesh(state_->device, scene, scene.mesh, content);
  if (content == Content::kOccluders) return;
  for (const SceneMover& mover : scene.movers) {
    state_->movers.push_back(
        BuildMesh(state_->device, scene, mover.mesh, content));
    state_->balls.push_back(BallAbout(mover.mesh));
  }
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

RayCaster::Placement::Placement(std::unique_ptr<State> state)
    : state_(std::move(state)) {}
RayCaster::Placement::~Placement() = default;
RayCaster::Placement::Placement(Placement&&) noexcept = default;
RayCaster::Placement& RayCaster::Placement::operator=(Placement&&) noexcept =
    default;

RayCaster::Placement RayCaster::Place(
    std::span<const Eigen::Isometry3d> X_WP) const {
  WAYMARK_CHECK(X_WP.size() == state_->movers.size(),
                X_WP.size(),
                "poses for",
                state_->movers.size(),
                "movers");
  auto placed = std::make_unique<Placement::State>();
  if (!X_WP.empty()) {
    placed->scene = SceneHandle(rtcNewScene(state_->device));
    rtcSetSceneFlags(placed->scene.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < X_WP.size(); ++i) {
      RTCGeometry instance =
          rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(instance, state_->movers[i].get());
      const Eigen::Matrix<float, 3, 4> matrix =
          X_WP[i].matrix().topRows<3>().cast<float>();
      rtcSetGeometryTransform(
          instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
      rtcCommitGeometry(instance);
      rtcAttachGeometryByID(
          placed->scene.get(), instance, static_cast<unsigned>(i));
      rtcReleaseGeometry(instance);
      placed->balls.push_back(
          {X_WP[i] * state_->balls[i].middle, state_->balls[i].radius});
    }
    rtcCommitScene(placed->scene.get());
    ThrowOnError(state_->device);
  }
  return Placement(std::move(placed));
}

void RayCaster::Trace(RayPacket* packet, const Placement* placement) const {
  RTCRayHit8 hits;
  alignas(32) int valid[kLanes];
  CopyRays(*packet, &hits.ray, valid);
  for (int i = 0; i < kLanes; ++i) {
    hits.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    hits.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    hits.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context = ContextOf(*packet);
  rtcIntersect8(valid, state_->mesh.get(), &context, &hits);
  if (placement != nullptr) {
    std::uint32_t near = 0;
    for (const Ball& ball : placement->state_->balls) {
      near |= LanesNear(*packet, ball);
    }
    if ((near & packet->active) != 0) {
      rtcIntersect8(valid, placement->state_->scene.get(), &context, &hits);
    }
  }
  // Where nothing was met the IDs are the ones set above.
  static_assert(RTC_INVALID_GEOMETRY_ID == RayPacket::kNothing);
  static_assert(std::bit_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID) ==
                RayPacket::kStatic);
  for (int i = 0; i < kLanes; ++i) {
    packet->triangle[i] = hits.hit.primID[i];
    packet->distance[i] = hits.ray.tfar[i];
    packet->mover[i] = static_cast<std::int32_t>(hits.hit.instID[0][i]);
  }
}

std::uint32_t RayCaster::Occluded(const RayPacket& packet) const {
  RTCRay8 rays;
  alignas(32) int valid[kLanes];
  CopyRays(packet, &rays, valid);
  RTCIntersectContext context = ContextOf(packet);
  rtcOccluded8(valid, state_->mesh.get(), &context, &rays);
  std::uint32_t occluded = 0;
  for (int i = 0; i < kLanes; ++i) {
    // Embree marks them by an end before the start.
    if (rays.tfar[i] < 0.0f) occluded |= packet.active & (1u << i);
  }
  return occluded;
}

std::size_t RayCaster::num_bytes() const {
  return static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(0, state_->num_bytes.load()));
}

void SetOrigin(const Eigen::Vector3f& origin, RayPacket* packet) {
  for (int axis = 0; axis < 3; ++axis) {
    std::fill_n(packet->origin[axis], kLanes, origin[axis]);
  }
  std::fill_n(packet->nearest, kLanes, 0.0f);
  std::fill_n(packet->farthest, kLanes, std::numeric_limits<float>::infinity());
}

}  // namespace waymark

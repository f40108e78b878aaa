#include "drivers/simulator/ray_caster.h"

#include "drivers/simulator/simd.h"
#include "estimation/base/check.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstring>
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

static_assert(offsetof(RayPacket, direction) == offsetof(RTCRay8, dir_x));
static_assert(offsetof(RayPacket, distance) == offsetof(RTCRay8, tfar));
static_assert(offsetof(RayPacket, unused_out) == sizeof(RTCRay8));
static_assert(offsetof(RayPacket, triangle) ==
              offsetof(RTCRayHit8, hit) + offsetof(RTCHit8, primID));
static_assert(offsetof(RayPacket, mover) ==
              offsetof(RTCRayHit8, hit) + offsetof(RTCHit8, instID));
static_assert(offsetof(RayPacket, farthest) == sizeof(RTCRayHit8));
// Where nothing was met the IDs are the ones set before.
static_assert(RTC_INVALID_GEOMETRY_ID == RayPacket::kNothing);
static_assert(std::bit_cast<std::int32_t>(RTC_INVALID_GEOMETRY_ID) ==
              RayPacket::kStatic);

// Embree's form of the active lanes: -1, others 0.
struct alignas(32) ValidLanes {
  Int4 low;
  Int4 high;

  explicit ValidLanes(std::uint32_t active) {
    const auto bits = static_cast<std::int32_t>(active);
    const Int4 all{bits, bits, bits, bits};
    const Int4 first{1, 2, 4, 8};
    const Int4 second{16, 32, 64, 128};
    low = (all & first) == first;
    high = (all & second) == second;
  }
  [[nodiscard]] const int* data() const {
    return reinterpret_cast<const int*>(this);
  }
};

RTCIntersectContext ContextOf(const RayPacket& packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = packet.is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                     : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

}  // namespace

struct RayCaster::State {
  // Before the device, which counts until its end.
  std::atomic<std::ptrdiff_t> num_bytes = 0;
  RTCDevice device = nullptr;
  SceneHandle mesh;
  std::vector<SceneHandle> movers;

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
    }
    rtcCommitScene(placed->scene.get());
    ThrowOnError(state_->device);
  }
  return Placement(std::move(placed));
}

void RayCaster::Trace(RayPacket* packet, const Placement* placement) const {
  std::memcpy(packet->distance, packet->farthest, sizeof packet->distance);
  std::fill_n(packet->triangle, kLanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(packet->unused_geometry, kLanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(packet->mover, kLanes, RayPacket::kStatic);
  const ValidLanes valid(packet->active);
  auto* hits = reinterpret_cast<RTCRayHit8*>(packet);
  RTCIntersectContext context = ContextOf(*packet);
  rtcIntersect8(valid.data(), state_->mesh.get(), &context, hits);
  if (placement != nullptr && placement->state_->scene.get() != nullptr) {
    rtcIntersect8(valid.data(), placement->state_->scene.get(), &context, hits);
  }
}

std::uint32_t RayCaster::Occluded(const RayPacket& packet) const {
  RTCRay8 rays;
  std::memcpy(&rays, &packet, sizeof rays);
  std::memcpy(rays.tfar, packet.farthest, sizeof rays.tfar);
  const ValidLanes valid(packet.active);
  RTCIntersectContext context = ContextOf(packet);
  rtcOccluded8(valid.data(), state_->mesh.get(), &context, &rays);
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

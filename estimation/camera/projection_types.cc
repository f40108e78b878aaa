#include "estimation/camera/projection_types.h"

#include <Eigen/LU>

namespace waymark {

Eigen::Matrix<double, 3, 2> InverseJacobian(
    const Eigen::Matrix<double, 2, 3>& d_point) {
  // Moore-Penrose: the smallest change of the bearing that moves the pixel so,
  // which has no part along the bearing, as a unit vector's must.
  const Eigen::Matrix2d gram = d_point * d_point.transpose();
  return d_point.transpose() * gram.inverse();
}

}  // namespace waymark

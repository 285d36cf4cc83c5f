// SPDX-License-Identifier: MIT
// Initialisation of ODE for the process and for each thread, and owning pointers to its objects. Any thread.
// Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace coopdyn {

/// An error inside ODE, which would otherwise end the process.
class OdeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes ODE ready for the calling thread: the library once per process, its per-thread data once per thread.
/// From then on, ODE's errors and failed assertions throw OdeError out of the called ODE function.
void EnsureOde();

/// Whether ODE has complained in this thread since the last call: its direct solver gave up on an island, and
/// left some of its constraints without force.
bool TakeOdeComplaint();

/// Frees an ODE object by ODE's destroy function for it.
template <auto Destroy>
struct OdeDelete {
  template <typename T>
  void operator()(T* object) const {
    Destroy(object);
  }
};
using OdeWorldPtr = std::unique_ptr<std::remove_pointer_t<dWorldID>, OdeDelete<dWorldDestroy>>;
using OdeGroupPtr = std::unique_ptr<std::remove_pointer_t<dJointGroupID>, OdeDelete<dJointGroupDestroy>>;
using OdeGeomPtr = std::unique_ptr<std::remove_pointer_t<dGeomID>, OdeDelete<dGeomDestroy>>;
using OdeMeshDataPtr =
    std::unique_ptr<std::remove_pointer_t<dTriMeshDataID>, OdeDelete<dGeomTriMeshDataDestroy>>;
using OdeThreadingPtr = std::unique_ptr<std::remove_pointer_t<dThreadingImplementationID>,
                                        OdeDelete<dThreadingFreeImplementation>>;

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Things of ODE's objects. Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <type_traits>

namespace coopdyn {

/// Frees an ODE object by the function made for it.
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
using OdeThreadingPtr = std::unique_ptr<std::remove_pointer_t<dThreadingImplementationID>,
                                        OdeDelete<dThreadingFreeImplementation>>;

}  // namespace coopdyn

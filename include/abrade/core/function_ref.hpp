#pragma once
// A function that is handed on by its address.

#include <concepts>
#include <memory>
#include <type_traits>

namespace abrade::detail {

/// Whatever can be called with Args, by its address, as C++26's std::function_ref: what takes it is compiled
/// once and not for each callable. The callable must outlive it.
template <class... Args>
class FunctionRef {
public:
    FunctionRef() = default;
    template <class Callable>
    requires(!std::same_as<std::remove_cvref_t<Callable>, FunctionRef>) FunctionRef(Callable&& callable)
    noexcept
        : call_([](void* what, Args... args) {
              (*static_cast<std::remove_reference_t<Callable>*>(what))(args...);
          }),
          what_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))) {}

    void operator()(Args... args) const { call_(what_, args...); }

private:
    void (*call_)(void*, Args...) = nullptr;
    void* what_ = nullptr;
};

}  // namespace abrade::detail

#pragma once
// A function that is handed on by its address.

#include <concepts>
#include <memory>
#include <type_traits>

namespace abrade::detail {

/// Refers to an object that can be called with Args without owning it, as C++26's std::function_ref does: a
/// function that takes one is compiled once and not for each callable. The object must outlive it.
template <class... Args>
class FunctionRef {
public:
    FunctionRef() = default;
    template <class Callable>
    requires(!std::same_as<std::remove_cvref_t<Callable>, FunctionRef> && std::invocable<Callable&, Args...>)
        FunctionRef(Callable&& callable)
        : call_([](void* what, Args... args) {
              (*static_cast<std::remove_reference_t<Callable>*>(what))(args...);
          }),
          callable_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))) {}

    void operator()(Args... args) const { call_(callable_, args...); }

private:
    void (*call_)(void*, Args...) = nullptr;
    void* callable_ = nullptr;
};

}  // namespace abrade::detail

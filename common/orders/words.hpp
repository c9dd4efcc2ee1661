// Words of Operator::order that more than one process goes by.
#pragma once

namespace fathom::orders {

/// Asks the supervisor whether it would arm where the vehicle is; nothing is armed by it.
inline constexpr char kPreflight[] = "preflight";
/// With enable: arms for a controller of somebody else's; the supervisor stays out of it.
inline constexpr char kOther[] = "other";

}  // namespace fathom::orders

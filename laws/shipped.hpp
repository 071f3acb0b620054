/// The laws that rosin ships, as types, in the order in which they are listed: one line each.
#pragma once
#include "laws/ageing.hpp"
#include "laws/bowden_tabor.hpp"
#include "laws/coulomb.hpp"
#include "laws/dahl.hpp"
#include "laws/film.hpp"
#include "laws/flash_heating.hpp"
#include "laws/hot_film.hpp"
#include "laws/hyperbolic.hpp"
#include "laws/kato_growth.hpp"
#include "laws/kato_tullis.hpp"
#include "laws/loading_rate.hpp"
#include "laws/lugre.hpp"
#include "laws/lugre_unscaled.hpp"
#include "laws/nagata.hpp"
#include "laws/prz.hpp"
#include "laws/slip.hpp"
#include "laws/slip_distance.hpp"
#include "laws/slip_weakening.hpp"
#include "laws/spinodal.hpp"
#include "laws/static_growth.hpp"
#include "laws/stribeck.hpp"
#include "laws/tabulated.hpp"
#include "laws/thermal.hpp"
#include "laws/thermal_disc.hpp"
#include "laws/thermal_layer.hpp"
#include "laws/two_exponential.hpp"
#include "laws/two_state_ageing.hpp"
#include "laws/two_state_slip.hpp"

namespace rosin::laws {

template <template <class> class... L>
struct LawList {};

using Shipped = LawList<Coulomb,         //
                        Stribeck,        //
                        Hyperbolic,      //
                        TwoExponential,  //
                        Tabulated,       //
                        Ageing,          //
                        Slip,            //
                        Prz,             //
                        KatoTullis,      //
                        Nagata,          //
                        TwoStateAgeing,  //
                        TwoStateSlip,    //
                        Spinodal,        //
                        BowdenTabor,     //
                        FlashHeating,    //
                        Lugre,           //
                        LugreUnscaled,   //
                        Dahl,            //
                        SlipDistance,    //
                        SlipWeakening,   //
                        StaticGrowth,    //
                        KatoGrowth,      //
                        LoadingRate,     //
                        Thermal,         //
                        ThermalDisc,     //
                        ThermalLayer,    //
                        Film,            //
                        HotFilm>;

}  // namespace rosin::laws

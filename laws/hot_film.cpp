/// Compiles the film law that warms into all its forms.
#include "laws/hot_film.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::HotFilm<double>&);

"""Kalman filters: predict, weigh, update. A robust filter is the one update with other weights.

Importing this package registers the weights of `robins.kalman.weights` and of the modules imported below, then those
of installed plug-ins, always in this order: the order is part of the compiled filters. Then the list is closed.
"""

from robins import plugins
from robins.kalman import chi_square, gates, m_estimators, tuning, weights

__all__ = ["chi_square", "gates", "m_estimators", "tuning", "weights"]

for _entry in plugins.found(plugins.WEIGHTS):
    _entry.load()
weights.close_list()

"""Ghouneem and Wassal (2024): RISS and GPS, EKF against UKF with self-tuning and an integrity gate."""

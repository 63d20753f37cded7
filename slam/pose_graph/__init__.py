"""Pose graphs: poses tied by relative measurements, their sparse least-squares adjustment and initialisation."""

"""Real recordings: readers that refuse a wrong file, and experiments that compare what they hold with theory."""
